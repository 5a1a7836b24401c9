"""What is wrong with the built site: dead links, orphans, and what it would load from elsewhere.

    python docs/site/check.py out/docs

Links that a reader follows may lead out; nothing that a browser loads by itself may. Exit code 0
where nothing is wrong, 1 where something is, 2 where there is no site.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urldefrag, urlsplit

# What a browser loads without being asked, by tag and attribute; `link` by what it is for.
LOADED = {
    ("img", "src"),
    ("img", "srcset"),
    ("script", "src"),
    ("iframe", "src"),
    ("source", "src"),
    ("video", "src"),
    ("audio", "src"),
    ("embed", "src"),
    ("object", "data"),
    ("use", "href"),
}
LINKS = {"stylesheet", "icon", "preload", "modulepreload", "manifest", "shortcut icon"}
IN_STYLE = re.compile(r"url\(\s*['\"]?([^'\")]+)|@import\s+['\"]([^'\"]+)")
MADE_BY_SPHINX = {"genindex.html", "py-modindex.html", "search.html"}  # led to by the theme's own


@dataclass
class Page(HTMLParser):
    """One page: where it leads, what it loads, and what can be led to."""

    leads: list[str] = field(default_factory=list)
    loads: list[str] = field(default_factory=list)
    names: set[str] = field(default_factory=set)

    def __post_init__(self) -> None:
        super().__init__(convert_charrefs=True)
        self.in_style = False

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Take in an element."""
        self.in_style = tag == "style"
        told = {name: value or "" for name, value in attrs}
        self.names |= {told[name] for name in ("id", "name") if told.get(name)}
        self.loads += styled(told.get("style", ""))
        if tag == "a" and told.get("href"):
            self.leads.append(told["href"])
        if tag == "link" and told.get("rel") in LINKS:
            self.loads.append(told.get("href", ""))
        self.loads += [value for name, value in told.items() if (tag, name) in LOADED]

    def handle_data(self, data: str) -> None:
        """Take in what stands in a style sheet."""
        if self.in_style:
            self.loads += styled(data)

    def handle_endtag(self, tag: str) -> None:
        """Leave a style sheet."""
        self.in_style = self.in_style and tag != "style"


def styled(text: str) -> list[str]:
    """Return what a style sheet loads."""
    return [one or other for one, other in IN_STYLE.findall(text)]


def is_outside(link: str) -> bool:
    """Tell whether a link leaves the site; data that stands in the page does not."""
    parts = urlsplit(link)
    return bool(parts.netloc) or parts.scheme not in ("", "data")


def faults_of(site: Path) -> list[str]:
    """Return what is wrong with a site, in words, sorted.

    Parameters
    ----------
    site : Path
        The folder that holds its ``index.html``.
    """
    site = site.resolve()
    pages = {path: read(path) for path in sorted(site.rglob("*.html"))}
    led_to = {site / "index.html"} | {site / name for name in MADE_BY_SPHINX}
    found = []
    for path, page in pages.items():
        where = path.relative_to(site)
        for link in page.loads:
            if is_outside(link):
                found.append(f"{where}: would load {link}")
        for link in [*page.leads, *page.loads]:
            if is_outside(link) or link.startswith("data:"):
                continue
            place, name = target(path, link)
            if place not in pages and not place.is_file():
                found.append(f"{where}: leads to {link}, which is not there")
            elif name and place in pages and name not in pages[place].names:
                found.append(f"{where}: leads to {link}, whose end is not there")
            elif place != path:
                led_to.add(place)
    found += [
        f"{path.relative_to(site)}: no page leads here" for path in pages if path not in led_to
    ]
    return sorted({*found, *style_faults(site)})


def style_faults(site: Path) -> Iterator[str]:
    """Walk what style sheets and scripts of the site would load from elsewhere."""
    for path in sorted(site.rglob("*.css")):
        for link in styled(path.read_text()):
            if is_outside(link):
                yield f"{path.relative_to(site)}: would load {link}"


def read(path: Path) -> Page:
    """Read a page."""
    page = Page()
    page.feed(path.read_text())
    return page


def target(path: Path, link: str) -> tuple[Path, str]:
    """Return the file that a link of a page leads to, and the name within it."""
    place, name = urldefrag(link)
    place = unquote(place).partition("?")[0]
    whole = (path.parent / place).resolve() if place else path
    return (whole / "index.html" if whole.is_dir() else whole), unquote(name)


def main() -> int:
    """Check the site named on the command line."""
    site = Path(sys.argv[1] if len(sys.argv) > 1 else "out/docs")
    if not (site / "index.html").is_file():
        print(
            f"expected a site with an index.html in {site}; `make docs` builds it", file=sys.stderr
        )
        return 2
    faults = faults_of(site)
    for fault in faults:
        print(fault)
    count = len(list(site.rglob("*.html")))
    print(
        f"{count} pages, {len(faults) or 'no'} faults: no dead link, orphan or request to elsewhere"
        if not faults
        else f"{count} pages, {len(faults)} faults"
    )
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
