"""Rules of the house that no linter knows."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

HOUSE = Path(__file__).resolve().parents[2]
ROOMS = ("models", "renders", "pipelines", "bench")
FILES = [path for room in ROOMS for path in sorted((HOUSE / room).rglob("*.py"))]
MOST_LINES = 400
SAYS_NOTHING = {"utils", "util", "core", "base", "misc", "helpers", "common", "tools"}

# Words for a pose whose frames its own docstring tells, where a second `a_from_b` would not.
POSE_WORDS = {"pose", "prior", "start", "truth", "estimate", "other", "guess", "predicted"}
ARROW_NAME = re.compile(r"(^|_)[A-Za-z]+2[A-Z]")  # A2B: which way does it map?


def named(path: Path) -> str:
    return str(path.relative_to(HOUSE))


@pytest.mark.parametrize("path", FILES, ids=named)
def test_a_file_says_one_thing_and_has_a_name(path):
    assert len(path.read_text().splitlines()) <= MOST_LINES
    assert path.stem not in SAYS_NOTHING


def public(body: list[ast.stmt]) -> Iterator[ast.FunctionDef | ast.ClassDef]:
    """Walk public functions and classes, and the public methods of those classes."""
    for node in body:
        if isinstance(node, ast.FunctionDef | ast.ClassDef) and not node.name.startswith("_"):
            yield node
            if isinstance(node, ast.ClassDef):
                yield from public(node.body)


def is_overload(node: ast.FunctionDef | ast.ClassDef) -> bool:
    return any(ast.unparse(decorator) == "overload" for decorator in node.decorator_list)


@pytest.mark.parametrize("path", FILES, ids=named)
def test_what_is_public_has_a_docstring(path):
    tree = ast.parse(path.read_text())
    assert ast.get_docstring(tree)
    bare = [n.name for n in public(tree.body) if not ast.get_docstring(n) and not is_overload(n)]
    assert not bare


def pose_names(tree: ast.Module) -> Iterator[str]:
    """Walk the names that are annotated as one rigid transform."""
    for node in ast.walk(tree):
        if isinstance(node, ast.arg) and node.annotation is not None:
            name, annotation = node.arg, ast.unparse(node.annotation)
        elif isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            name, annotation = node.target.id, ast.unparse(node.annotation)
        else:
            continue
        if annotation.split(" | ")[0] == "RigidTransform":
            yield name


@pytest.mark.parametrize("path", FILES, ids=named)
def test_poses_say_from_where_to_where(path):
    tree = ast.parse(path.read_text())
    for name in pose_names(tree):
        assert "_from_" in name or name.lstrip("_") in POSE_WORDS, name
    assert not [name for name in own_names(tree) if ARROW_NAME.search(name)]


def own_names(tree: ast.Module) -> Iterator[str]:
    """Walk the names that a file gives: variables, parameters, functions."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            yield node.id
        elif isinstance(node, ast.arg):
            yield node.arg
        elif isinstance(node, ast.FunctionDef):
            yield node.name


def test_the_rule_for_poses_can_fail():
    """The test above, tested: a frameless name and an arrow are seen."""
    tree = ast.parse("def f(transform: RigidTransform, cam_from_target: RigidTransform): ...")
    assert list(pose_names(tree)) == ["transform", "cam_from_target"]
    assert list(own_names(ast.parse("A2B = f(C2D)"))) == ["A2B"]
    assert ARROW_NAME.search("T_cam2World")
    assert ARROW_NAME.search("A2B")
    assert not ARROW_NAME.search("r2")
    assert not ARROW_NAME.search("variance_e2")


@pytest.mark.parametrize("room", ROOMS)
def test_every_room_has_a_door_sign(room):
    sign = (HOUSE / room / "README.md").read_text()
    assert "Never here" in sign
    assert "Start with" in sign
