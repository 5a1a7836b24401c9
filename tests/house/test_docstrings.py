"""What a public docstring owes its reader: shapes, parameters and errors, by name."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

HOUSE = Path(__file__).resolve().parents[2]
ROOMS = ("models", "renders", "pipelines", "bench")

# Rooms under the hammer: they are being rebuilt, and owe their docstrings when they are done.
# Strike a line as soon as its room is; nothing may be added.
ROOMS_UNDER_THE_HAMMER = {
    "models/dataset/": "streams",
    "models/frame.py": "streams",
    "models/estimate.py": "streams",
    "models/uncooperative.py": "streams",
    "pipelines/chaser_fixed/": "one way to make a pipeline",
    "pipelines/uncooperative/": "one way to make a pipeline",
    "renders/world/": "worlds composed of parts",
    "renders/scenario/": "worlds composed of parts",
    "renders/batches/": "one producer a stream",
    "renders/truth/": "one producer a stream",
    "bench/*.py": "one engine for all chains",
    "bench/chains/": "one engine for all chains",
    "bench/estimating/": "one engine for all chains",
    "bench/scoring/": "one engine for all chains",
    "bench/report/": "one engine for all chains",
    "bench/pictures/": "one engine for all chains",
}

PARAMETERS_FROM = 3  # so many parameters, self aside, and each has its entry
ARRAYS = re.compile(r"\b(Floats|Mask|Indices|Image|Labels|Radiance|AnyArray|NDArray|ArrayLike)\b")
# (n, 3), (3,), (..., 3), (height, width, 3), (2 n,), (m - 1, 4); or one number.
EXTENT = r"(?:\.\.\.|[\w]+(?: ?[-+*/]? ?\w+)*)"
SHAPE = re.compile(rf"\({EXTENT}(?:,\s{EXTENT})*(?:,\s{EXTENT}|,)\)|\bscalars?\b")
HEADING = re.compile(r"^(\w+(?: \w+)*)\n-{3,}$", re.MULTILINE)
ENTRY = re.compile(r"^(\*{0,2}\w+(?:, \*{0,2}\w+)*)(?: ?:|$)")


def under_the_hammer(name: str) -> bool:
    return any(
        name.startswith(place) or (place.endswith("/*.py") and str(Path(name).parent / "*.py") == place)
        for place in ROOMS_UNDER_THE_HAMMER
    )


NAMES = [
    str(path.relative_to(HOUSE)) for room in ROOMS for path in sorted((HOUSE / room).rglob("*.py"))
]
OWING = [name for name in NAMES if not under_the_hammer(name)]


def errors_of_the_house() -> set[str]:
    """Return ValueError and every class that descends from RvbenchError, wherever it is."""
    parents = {}
    for name in NAMES:
        for node in ast.walk(ast.parse((HOUSE / name).read_text())):
            if isinstance(node, ast.ClassDef):
                parents[node.name] = {ast.unparse(parent).split(".")[-1] for parent in node.bases}
    known = {"RvbenchError"}
    while more := {name for name in parents.keys() - known if parents[name] & known}:
        known |= more
    return known | {"ValueError"}


ERRORS = errors_of_the_house()


def functions(
    body: list[ast.stmt], owner: ast.ClassDef | None = None
) -> Iterator[tuple[ast.FunctionDef, ast.ClassDef | None]]:
    """Walk public functions and methods that do something, with the class that owns them."""
    for node in body:
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            yield from functions(node.body, node)
        if isinstance(node, ast.FunctionDef) and not node.name.startswith("_"):
            decorators = {ast.unparse(each).split(".")[-1] for each in node.decorator_list}
            if not decorators & {"overload", "property", "cached_property", "setter"}:
                if not is_stub(node):
                    yield node, owner


def is_stub(node: ast.FunctionDef) -> bool:
    return isinstance(last := node.body[-1], ast.Expr) and ast.unparse(last) == "..."


def sections(docstring: str) -> dict[str, str]:
    """Split a numpydoc docstring at its headings; what stands before them is under ``""``."""
    pieces = HEADING.split(docstring)
    return dict(zip(["", *pieces[1::2]], pieces[::2], strict=True))


def entries(section: str) -> dict[str, str]:
    """Return the text of each name that a Parameters section tells of."""
    told: dict[str, str] = {}
    names: list[str] = []
    for line in section.splitlines():
        if entry := ENTRY.match(line):
            names = [name.strip("*") for name in entry[1].split(", ")]
        for name in names:
            told[name] = f"{told.get(name, '')}\n{line}"
    return told


def raised(node: ast.FunctionDef) -> set[str]:
    """Return the house's errors that a function's own body raises, nested functions left out."""
    found = set()
    rest: list[ast.AST] = list(node.body)
    while rest:
        each = rest.pop()
        if isinstance(each, ast.FunctionDef | ast.Lambda | ast.ClassDef):
            continue
        if isinstance(each, ast.Raise) and isinstance(each.exc, ast.Call):
            found.add(ast.unparse(each.exc.func).split(".")[-1])
        rest.extend(ast.iter_child_nodes(each))
    return found & ERRORS


def is_array(annotation: ast.expr | None) -> bool:
    return annotation is not None and ARRAYS.search(ast.unparse(annotation)) is not None


def debts(node: ast.FunctionDef, owner: ast.ClassDef | None) -> Iterator[str]:
    """Say what a function's docstring leaves untold."""
    told = sections(ast.get_docstring(node) or "")
    of_class = sections(ast.get_docstring(owner) or "") if owner else {}
    arguments = [*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs]
    arguments += [each for each in (node.args.vararg, node.args.kwarg) if each]
    parameters = {each.arg: each for each in arguments if each.arg not in ("self", "cls")}

    entry = entries(told.get("Parameters", ""))
    if "Parameters" in told or len(parameters) >= PARAMETERS_FROM:
        yield from (f"{name}: no entry" for name in parameters if name not in entry)
    for name, parameter in parameters.items():
        text = entry.get(name, "") if entry else told[""]
        if is_array(parameter.annotation) and not SHAPE.search(text):
            yield f"{name}: no shape"
    outside = told.get("Returns", "") + told.get("Yields", "") or told[""]
    if is_array(node.returns) and not SHAPE.search(outside):
        yield "returns: no shape"
    errors = told.get("Raises", "") + of_class.get("Raises", "")
    for error in sorted(raised(node)):
        if not re.search(rf"^{error}\b|, {error}\b", errors, re.MULTILINE):
            yield f"raises {error}: untold"


def unpaid(source: str) -> list[str]:
    tree = ast.parse(source)
    return [f"{node.name}: {d}" for node, owner in functions(tree.body) for d in debts(node, owner)]


@pytest.mark.parametrize("name", OWING)
def test_a_docstring_tells_shapes_parameters_and_errors(name):
    assert not unpaid((HOUSE / name).read_text())
