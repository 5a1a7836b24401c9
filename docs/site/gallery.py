"""Renders the gallery anew: runs the blocks of ``docs/gallery.md`` and puts their pictures there.

    python -m docs.site.gallery [PICTURE ...]

Each picture is of the first file named after it that a block made: ``NAME.png``, or what the text
between two headings names in backquotes. ``make gallery`` runs this.
"""

from __future__ import annotations

import re
import sys
import tempfile
from pathlib import Path

from PIL import Image

from docs.site.page_blocks import blocks_of, do_block

DOCS = Path(__file__).resolve().parents[1]
PAGE = DOCS / "gallery.md"
WIDEST_PX, QUALITY = 1000, 72
PICTURE = re.compile(r"!\[[^\]]*\]\((images/gallery/([\w-]+)\.webp)\)")
NAMED = re.compile(r"`([\w./-]+\.png)`")


def main() -> int:
    """Render every picture of the gallery, or those that are named.

    Raises
    ------
    SystemExit
        If a block fails, or makes no picture.
    """
    asked = set(sys.argv[1:])
    with tempfile.TemporaryDirectory() as made_in:
        folder = Path(made_in)
        for section in re.split(r"^## ", PAGE.read_text(), flags=re.MULTILINE)[1:]:
            if asked and not asked & {found[2] for found in PICTURE.finditer(section)}:
                continue
            for block in blocks_of(section):
                do_block(block, folder)
            for found in PICTURE.finditer(section):
                made = picture_of(section, found[2], folder)
                keep(made, DOCS / found[1])
                print(f"{made.name}: {found[1]}", flush=True)
    return 0


def picture_of(section: str, name: str, folder: Path) -> Path:
    """Return the picture that a section's blocks made.

    Parameters
    ----------
    section : str
        Its text.
    name : str
        Of the picture in the gallery.
    folder : Path
        Where the blocks ran.

    Raises
    ------
    SystemExit
        If there is none.
    """
    for wanted in (f"{name}.png", *NAMED.findall(section)):
        if found := sorted(folder.rglob(wanted)):
            return found[-1]
    raise SystemExit(f"gallery: expected the blocks to make a picture of {name!r}, found none")


def keep(made: Path, place: Path) -> None:
    """Write a picture small, as WebP."""
    place.parent.mkdir(parents=True, exist_ok=True)
    with Image.open(made) as picture:
        small = picture.convert("RGB")
        small.thumbnail((WIDEST_PX, 4 * WIDEST_PX))
        small.save(place, quality=QUALITY, method=6)


if __name__ == "__main__":
    sys.exit(main())
