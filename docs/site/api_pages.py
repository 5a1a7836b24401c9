"""The pages of the API, one for each part of a room, made before each build."""

from __future__ import annotations

import ast
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:  # what is made can be tested where there is no Sphinx
    from sphinx.application import Sphinx

HOUSE = Path(__file__).resolve().parents[2]
PLACE = HOUSE / "docs" / "api"
ROOMS = ("models", "renders", "pipelines", "bench")
# Programs of the house's own, with nothing that another program would call.
LEFT_OUT = ("bench.examples", "bench.campaign", "bench.cycles", "bench.grain")
ROOM_PAGE = """\
# {room}

{first}

```{{toctree}}
:maxdepth: 1

{parts}
```
"""


def modules_of(part: Path) -> list[Path]:
    """Return a part's modules: itself if it is one, else all of its folder that say something."""
    if part.suffix == ".py":
        return [part]
    return sorted(path for path in part.rglob("*.py") if ast.parse(path.read_text()).body)


def name_of(path: Path) -> str:
    """Return a module's dotted name."""
    dotted = ".".join(path.relative_to(HOUSE).with_suffix("").parts)
    return dotted.removesuffix(".__init__")


def parts_of(room: str) -> list[Path]:
    """Return the modules and packages right in a room."""
    found = []
    for path in sorted((HOUSE / room).iterdir()):
        is_package = path.is_dir() and (path / "__init__.py").is_file()
        is_module = path.suffix == ".py" and not path.stem.startswith("__")
        if (is_package or is_module) and name_of(path) not in LEFT_OUT:
            found.append(path)
    return found


def page_of(part: Path) -> str:
    """Return the page of a part, as MyST."""
    lines = [f"# {name_of(part)}", ""]
    modules = modules_of(part)
    for path in modules:
        name = name_of(path)
        if len(modules) > 1 and name != name_of(part):
            lines += [f"## {name}", ""]
        lines += ["```{eval-rst}", f".. automodule:: {name}", "```", ""]
    return "\n".join(lines)


def pages() -> dict[str, str]:
    """Return the text of every page, by its file's name."""
    made = {}
    for room in ROOMS:
        parts = parts_of(room)
        first = ast.get_docstring(ast.parse((HOUSE / room / "__init__.py").read_text())) or ""
        names = "\n".join(name_of(part) for part in parts)
        made[f"{room}.md"] = ROOM_PAGE.format(room=room, first=first, parts=names)
        made |= {f"{name_of(part)}.md": page_of(part) for part in parts}
    return made


def write_pages(app: Sphinx) -> None:
    """Write the pages that changed, and take away those of what is gone."""
    PLACE.mkdir(exist_ok=True)
    made = pages()
    for path in PLACE.glob("*.md"):
        if path.name not in made and path.name != "index.md":
            path.unlink()
    for name, text in made.items():
        place = PLACE / name
        if not place.is_file() or place.read_text() != text:
            place.write_text(text)


def setup(app: Sphinx) -> dict[str, bool]:
    """Have Sphinx make them."""
    app.connect("builder-inited", write_pages)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
