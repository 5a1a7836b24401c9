"""What a public docstring owes its reader: shapes, parameters and errors, by name."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

HOUSE = Path(__file__).resolve().parents[2]
ROOMS = ("models", "renders", "pipelines", "bench")

NOT_CALLED = {"overload", "property", "cached_property", "setter"}
PARAMETERS_FROM = 3  # so many parameters, self aside, and each has its entry
ARRAYS = re.compile(r"\b(Floats|Mask|Indices|Image|Labels|Radiance|AnyArray|NDArray|ArrayLike)\b")
# (n, 3), (3,), (..., 3), (height, width, 3), (2 n,), (m - 1, 4); or one number.
EXTENT = r"(?:\.\.\.|[\w]+(?: ?[-+*/]? ?\w+)*)"
SHAPE = re.compile(rf"\({EXTENT}(?:,\s{EXTENT})*(?:,\s{EXTENT}|,)\)|\bscalars?\b")
HEADING = re.compile(r"^(\w+(?: \w+)*)\n-{3,}$", re.MULTILINE)
ENTRY = re.compile(r"^(\*{0,2}\w+(?:, \*{0,2}\w+)*)(?: ?:|$)")


NAMES = [
    str(path.relative_to(HOUSE)) for room in ROOMS for path in sorted((HOUSE / room).rglob("*.py"))
]


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
            if not decorators & NOT_CALLED and not is_stub(node):
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


def raised(node: ast.AST) -> set[str]:
    """Return the house's errors that leave a body by its own raise, nested functions left out."""
    if isinstance(node, ast.Try):
        caught = {ast.unparse(each.type) for each in node.handlers if each.type is not None}
        inside = set().union(*map(raised, node.body))
        stays = {error for error in inside if any(re.search(rf"\b{error}\b", c) for c in caught)}
        rest = [*node.handlers, *node.orelse, *node.finalbody]
        return inside - stays | set().union(*map(raised, rest))
    found = set()
    if isinstance(node, ast.Raise) and isinstance(node.exc, ast.Call):
        found = {ast.unparse(node.exc.func).split(".")[-1]} & ERRORS
    own = (
        each
        for each in ast.iter_child_nodes(node)
        if not isinstance(each, ast.FunctionDef | ast.Lambda | ast.ClassDef)
    )
    return found.union(*map(raised, own))


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


@pytest.mark.parametrize("name", NAMES)
def test_a_docstring_tells_shapes_parameters_and_errors(name):
    assert not unpaid((HOUSE / name).read_text())


WITHOUT_DEBTS = """
def pose(points: Floats, at_s: float, model: Model) -> Floats:
    \"\"\"Fit.

    Parameters
    ----------
    points : (n, 3) array, m
    at_s, model
        What it says.

    Returns
    -------
    (3,) array, m

    Raises
    ------
    ValueError
        If there is none.
    \"\"\"
    try:
        raise ScenarioError("is caught")
    except ScenarioError:
        raise ValueError("leaves")
"""


def test_a_docstring_that_tells_all_owes_nothing():
    assert unpaid(WITHOUT_DEBTS) == []
    assert unpaid('def f(a: Floats) -> Mask:\n    "Tell which, (n,), of (n, 3) m."\n    pass') == []
    assert unpaid("def f(a: Floats): ...") == []
    assert unpaid('class A:\n    @property\n    def b(self) -> Floats:\n        "Say."\n') == []


@pytest.mark.parametrize(
    ("told", "untold", "owed"),
    [
        ("points : (n, 3) array, m", "points : array, m", "points: no shape"),
        ("points : (n, 3) array, m", "points : array (which)", "points: no shape"),
        ("at_s, model\n", "at_s\n", "model: no entry"),
        ("(3,) array, m", "Where it is.", "returns: no shape"),
        ("    ValueError\n", "    KeyError\n", "raises ValueError: untold"),
        ("except ScenarioError", "except KeyError", "raises ScenarioError: untold"),
        ("Parameters\n    ----------\n", "", "points: no entry"),
    ],
)
def test_the_rule_for_docstrings_can_fail(told, untold, owed):
    """The test above, tested: what is left out is seen."""
    source = WITHOUT_DEBTS.replace(told, untold, 1)
    assert source != WITHOUT_DEBTS
    assert f"pose: {owed}" in unpaid(source)


def test_errors_of_the_house_are_found_wherever_they_are():
    assert {"ValueError", "ScenarioError", "StorageError"} <= ERRORS
    assert "RigidTransform" not in ERRORS
    assert len(NAMES) > 100
