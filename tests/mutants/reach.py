"""Which tests reach a line, by coverage.py, and what each costs; learned once for a test's file.

Every file of tests has a process of its own, so that what one leaves in a cache hides nothing from
the next. What is reached while a fixture is made counts for all tests of that file, for it may be
shared; what is reached while modules are imported counts for all that import them.
"""

from __future__ import annotations

import hashlib
import json
import time
from collections import defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import pytest

ROOMS = ("models", "renders", "pipelines", "bench")
WHILE_IMPORTED, SHARED = "", "shared"
QUIETLY = ("-q", "-p", "no:cacheprovider", "-W", "ignore::pytest.PytestAssertRewriteWarning")


@dataclass
class FileReach:
    """What the tests of one file reach."""

    tests: dict[str, float] = field(default_factory=dict)
    """Seconds of processor time of each test that passes, without its fixtures."""
    shared_s: float = 0.0
    """Seconds for what is imported and for all fixtures."""
    lines: dict[str, dict[str, list[int]]] = field(default_factory=dict)
    """Of each file of ours, by test, the lines reached; of all tests under the empty name."""
    sums: dict[str, str] = field(default_factory=dict)
    """Checksum of each file that was read."""


class Watch:
    """Tells coverage.py whose lines it counts, and what they cost; ends when enough was spent."""

    def __init__(self, coverage, most_s: float):
        self.coverage, self.most_s = coverage, most_s
        self.began_s, self.tests = time.process_time(), dict[str, float]()

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_setup(self, item):
        self.coverage.switch_context(SHARED)
        return (yield)

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_call(self, item):
        self.coverage.switch_context(item.nodeid)
        began = time.process_time()
        answer = yield  # a test that fails is not listed
        self.tests[item.nodeid] = round(time.process_time() - began, 3)
        return answer

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_teardown(self, item):
        self.coverage.switch_context(SHARED)
        if time.process_time() - self.began_s > self.most_s:
            item.session.shouldstop = "enough was spent on this file"
        return (yield)


def learn(test_file: str, most_s: float, kept: Path) -> None:
    """Run a file of tests here and write what it reaches; to be called in a process of its own."""
    from coverage import Coverage

    home = Path.cwd()
    coverage = Coverage(
        data_file=None, config_file=False, include=[f"{home}/{room}/*" for room in ROOMS]
    )
    watch = Watch(coverage, most_s)
    coverage.start()
    pytest.main([test_file, "-m", "not slow", *QUIETLY], [watch])
    coverage.stop()
    shared_s = time.process_time() - watch.began_s - sum(watch.tests.values())
    data, reach = coverage.get_data(), FileReach(watch.tests, round(shared_s, 3))
    for path in data.measured_files():
        own = str(Path(path).relative_to(home))
        by_test = defaultdict[str, list[int]](list)
        for line, contexts in data.contexts_by_lineno(path).items():
            for context in contexts:
                by_test[context].append(line)
        reach.lines[own], reach.sums[own] = dict(by_test), checksum(home / own)
    reach.sums[test_file] = checksum(home / test_file)
    kept.write_text(json.dumps(reach.__dict__))


@cache
def checksum(path: Path) -> str:
    """Return what changes when a file does."""
    return hashlib.sha256(path.read_bytes()).hexdigest()[:16] if path.is_file() else ""


def remembered(kept: Path, home: Path) -> FileReach | None:
    """Return what was learned, unless something that it rests on has changed since."""
    if not kept.is_file():
        return None
    reach = FileReach(**json.loads(kept.read_text()))
    fresh = all(checksum(home / file) == was for file, was in reach.sums.items())
    return reach if fresh else None


def tests_reaching(
    file: str, lines: Iterable[int], reached: Mapping[str, FileReach], most_s: float
) -> tuple[list[str], float]:
    """Choose tests that reach any of a file's lines: its own file's, its folder's, the cheapest.

    A constant is reached by whoever imports it; those that run something of its file come first.

    Returns
    -------
    tuple
        Names of tests, of each file together, and what they cost in seconds of processor time;
        as many as cost at most `most_s`, and one at least.
    """
    wanted, folder = set(lines), f"tests/{Path(file).parent}"
    own_file, found = f"{folder}/test_{Path(file).name}", []
    for test_file, reach in reached.items():
        by_test = reach.lines.get(file, {})
        direct = {t for t, own in by_test.items() if t in reach.tests and wanted & set(own)}
        imported = len(by_test) > 1 and wanted & set(by_test.get(WHILE_IMPORTED, ()))
        if not (direct or imported or wanted & set(by_test.get(SHARED, ()))):
            continue
        far = 0 if test_file == own_file else 1 if str(Path(test_file).parent) == folder else 2
        # The others of the file may use what a fixture, an import or a cache has kept of it.
        found += [
            (far, (test not in direct) + (test not in by_test), own_s, test, test_file)
            for test, own_s in reach.tests.items()
        ]
    chosen, files, cost_s = list[str](), set[str](), 0.0
    for *_, own_s, test, test_file in sorted(found):
        more_s = own_s + (0.0 if test_file in files else reached[test_file].shared_s)
        if not chosen or cost_s + more_s <= most_s:
            chosen.append(test)
            files.add(test_file)
            cost_s += more_s
    return chosen, cost_s
