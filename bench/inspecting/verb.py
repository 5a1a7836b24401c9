"""``rvbench inspect``: the verb."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from tyro.conf import Positional, arg

from models.plain_console import plain_console

DONE = 0


@dataclass(frozen=True)
class Inspect:
    """Look at a spacecraft of your own: what is wrong with its mesh, and a TOML to start from.

        rvbench inspect probe.glb
        rvbench inspect probe.toml

    Reads GLB, glTF, OBJ, STL and PLY. Of a mesh it writes probe.toml, and of either
    probe.inspect.png: six sides, the whole askew, and the wireframe that was found. Then
    `target = "probe.toml"` in a scenario makes it the target. What it says to `mend` will make
    pictures or motion wrong; the rest is good to know.
    """

    file: Positional[Annotated[Path, arg(metavar="FILE")]]
    """a mesh, or the TOML beside one"""
    out: Annotated[Path | None, arg(metavar="DIR", help_behavior_hint="")] = None
    """where the TOML and the picture go; else beside FILE"""
    variant: Literal["auto", "llvm", "cuda", "scalar"] = "auto"
    """how Mitsuba computes; auto takes the fastest that renders here"""

    def run(self) -> int:
        """Inspect."""
        from bench.inspecting.inspection import (
            check_start_place,
            inspect_file,
            print_inspection,
            title_of,
        )
        from bench.inspecting.start_text import start_text
        from bench.pictures.our_picture import check_picture_place
        from models.atomic_file import sweep_beside, write_bytes, write_text
        from renders.variant.choice import activate, choose_variant

        out = self.file.parent if self.out is None else self.out
        picture = out / f"{self.file.stem}.inspect.png"
        toml = out / f"{self.file.stem}.toml"
        is_mesh = self.file.suffix.lower() != ".toml"
        check_picture_place(picture)
        if is_mesh:
            check_start_place(toml)
        found = inspect_file(self.file, out)
        print_inspection(found, plain_console())
        if is_mesh:
            text = start_text(
                found.target.description,
                found.mesh,
                found.placed,
                toml.name,
                found.unit_is_guessed,
            )
            sweep_beside(toml)
            write_text(toml, text)
            print(f"spacecraft: {toml}")
        activate(choose_variant(self.variant))
        from bench.inspecting.picture import side_picture

        craft = found.target.spacecraft
        sweep_beside(picture)
        write_bytes(picture, side_picture(craft, found.target.wireframe, title_of(found)))
        print(f"picture: {picture}")
        return DONE
