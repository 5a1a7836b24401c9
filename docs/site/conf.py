"""How Sphinx builds the site: ``make docs``. The pages are Markdown, in ``docs/``."""

from __future__ import annotations

import re
import sys
import tomllib
from pathlib import Path

HOUSE = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(HOUSE))

ROOMS = ("models", "renders", "pipelines", "bench")


def type_variables() -> list[str]:
    """Return the names of the rooms' type variables, which have no page of their own."""
    texts = (path.read_text() for room in ROOMS for path in (HOUSE / room).rglob("*.py"))
    names = (re.findall(r"^(\w+) = TypeVar\(", text, re.MULTILINE) for text in texts)
    return sorted({name for own in names for name in own})


PROJECT = tomllib.loads((HOUSE / "pyproject.toml").read_text())["project"]

project = "rvbench"
author = "The rvbench developers"
copyright = "The rvbench developers, Apache-2.0"
version = release = PROJECT["version"]

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_copybutton",
    "docs.site.api_pages",
    "docs.site.docstring_text",
    "docs.site.mathml",
    "docs.site.named_code",
    "docs.site.recorded",
]
exclude_patterns = ["site", "notebooks"]
source_suffix = {".md": "markdown"}
nitpicky = True
nitpick_ignore_regex = [
    # Types in signatures: of libraries, of the standard library, private, or told in words.
    ("py:.*", r"(?!(models|renders|pipelines|bench)\.).*"),
    ("py:.*", rf".*\.(_\w+|Annotated|{'|'.join(type_variables())})$"),
]
suppress_warnings = ["config.cache"]

myst_enable_extensions = ["dollarmath", "deflist"]
myst_heading_anchors = 3

autodoc_mock_imports = ["mitsuba", "drjit"]  # no variant is set while a site is built
autodoc_default_options = {"members": True, "show-inheritance": True}
autodoc_member_order = "bysource"
autodoc_typehints_format = "short"
python_use_unqualified_type_names = True
napoleon_google_docstring = False
napoleon_use_rtype = False

html_theme = "furo"
html_title = "rvbench"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sphinx = False
html_extra_path: list[str] = []
html_theme_options = {"navigation_with_keys": True}
pygments_style = "friendly"
pygments_dark_style = "github-dark"
