"""The slips, slipped: each is made where it can be, gives code that parses, and changes a value."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

from tests.mutants import reach as reaching
from tests.mutants.harmless import EQUIVALENT, HOLE, JUDGEMENT, LIST, kind_of, read_harmless
from tests.mutants.mutation import is_numeric, places
from tests.mutants.reach import FileReach
from tests.mutants.slips import ONE_PERCENT

HOUSE = Path(__file__).resolve().parents[2]


def changed(source: str) -> set[str]:
    return {
        mutant.of(source.encode()).decode()
        for slips in places("file.py", source.encode())
        for mutant in slips
    }


@pytest.mark.parametrize(
    ("source", "slipped"),
    [
        ("x < y", {"x <= y", "x > y"}),
        ("(x) - (y)", {"(x) + (y)", "(x)", "(y) - (x)"}),
        ("a @ b.T", {"(b.T) @ (a)", "a @ b"}),
        ("np.cross(a, b)", {"np.cross(b, a)"}),
        ("arctan2(y, x)", {"arctan2(x, y)"}),
        ("np.sin(x)", {"np.cos(x)"}),
        ("f(x, axis=-1)", {"f(x, axis=0)"}),
        ("f(x, axis=0)", {"f(x, axis=1)"}),
        ("np.all(x)", {"np.any(x)"}),
        ("-x", {"(x)"}),
        ("2.0", {"2.02", "4.0", "(-2.0)"}),
        ("3", {"2", "4"}),
        ("pose.inverse()", {"(pose)"}),
        ("ä or x and y", {"ä and x and y", "ä or x or y"}),
    ],
)
def test_a_slip_is_one_change(source, slipped):
    assert changed(source) == slipped


@pytest.mark.parametrize(
    "source",
    [
        "raise ValueError(f'{x + 1}')",
        "folder / name",
        "'a' + name",
        "x: Literal[3]",
        "field: float = Field(gt=0.0)",
        "kind == 'led'",
        "'2.0'",
    ],
)
def test_messages_names_and_declarations_are_left(source):
    assert not changed(source)


def test_every_slip_of_a_file_of_ours_is_code_and_another():
    file = "pipelines/filters/multiplicative_ekf.py"
    source = (HOUSE / file).read_bytes()
    assert is_numeric(HOUSE / file)
    mutants = [mutant for slips in places(file, source) for mutant in slips]
    assert len(mutants) > 20
    tree = ast.dump(ast.parse(source))
    for mutant in mutants:
        assert ast.dump(ast.parse(mutant.of(source))) != tree, mutant


def test_what_is_harmless_is_said_of_lines_that_are_there_with_a_reason():
    for kind, entries in read_harmless().items():
        assert kind in (EQUIVALENT, JUDGEMENT)
        for each in entries:
            assert len(each["why"]) > 15
            text = " ".join((HOUSE / each["file"]).read_text().split())
            for said in each["lines"] if kind == JUDGEMENT else [each["before"]]:
                assert said in text, f"{LIST.name}: no longer a line of {each['file']}: {said}"


def test_a_judgement_forgives_one_percent_and_no_more():
    entries = {"judgement": [{"file": "a.py", "lines": ["LIMIT = 3.0"], "why": ""}]}
    own = {"file": "a.py", "before": "LIMIT = 3.0", "after": "LIMIT = 3.03", "slip": ONE_PERCENT}
    assert kind_of(own, entries) == JUDGEMENT
    assert kind_of({**own, "slip": "number"}, entries) == HOLE
    assert kind_of({**own, "before": "OTHER = 3.0"}, entries) == HOLE


def test_the_tests_of_a_line_come_before_those_that_only_import_its_file():
    """Of a constant, those that run something of its file; what costs too much is left out."""
    reach = FileReach(
        {"runs": 2.0, "runs_the_line": 1.0, "imports": 0.1, "dear": 50.0},
        0.5,
        {"a.py": {"": [1, 2, 5], "runs": [6], "runs_the_line": [3], "dear": [3]}},
    )
    reached = {"tests/test_a.py": reach}
    constant, cost_s = reaching.tests_reaching("a.py", [1], reached, 3.55)
    assert constant == ["runs_the_line", "runs"]
    assert cost_s == 3.5
    every = ["runs_the_line", "runs", "imports"]
    assert reaching.tests_reaching("a.py", [1], reached, 9.0)[0] == every
    assert reaching.tests_reaching("a.py", [3], reached, 9.0)[0] == every
    assert reaching.tests_reaching("a.py", [4], reached, 9.0) == ([], 0.0)


def test_a_mutant_is_seen_on_import_and_the_file_is_as_it_was(tmp_path):
    """One test that knows of the sum, one that does not look: killed, and survived."""
    module, tests = tmp_path / "sums.py", tmp_path / "test_sums.py"
    module.write_text("def add(x, y):\n    return x + y\n")
    tests.write_text(
        "from sums import add\n\n\ndef test_of_sums():\n    assert add(2, 3) == 5\n"
        "\n\ndef test_that_it_runs():\n    add(2, 3)\n"
    )
    (tmp_path / "pytest.ini").write_text("[pytest]\n")
    before = module.read_bytes()
    script = (
        "import sys; from pathlib import Path\n"
        "from tests.mutants.mutation import places\n"
        "from tests.mutants.trial import judge\n"
        "mutant = next(places('sums.py', Path('sums.py').read_bytes()))[0]\n"
        "sys.exit(judge(mutant, [f'test_sums.py::{sys.argv[1]}']))\n"
    )
    for test, code in (("test_of_sums", 1), ("test_that_it_runs", 0)):
        done = subprocess.run(
            [sys.executable, "-c", script, test],
            cwd=tmp_path,
            env={"PYTHONPATH": f"{tmp_path}:{HOUSE}", "PATH": "/usr/bin:/bin"},
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == code, done.stdout + done.stderr
    assert module.read_bytes() == before
