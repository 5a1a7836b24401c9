"""Learns what tests reach, draws mutants and tries them; runs in a copy of the checkout."""

from __future__ import annotations

import json
import random
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from tests.mutants.children import BROKEN, Child, read_libraries, run_all
from tests.mutants.mutation import Mutant, is_numeric, places
from tests.mutants.reach import FileReach, learn, remembered, tests_reaching
from tests.mutants.trial import judge

SURVIVED = ("survived", "unreached")
CONTROL, CONTROLS = "control", 40  # of so many draws, one
READ_S = 30.0
"""Seconds of processor time that a mutant has beside five times what its tests take."""


@dataclass(frozen=True)
class Asked:
    """What is wanted."""

    rooms: Sequence[str]
    tests: Sequence[str]
    count: int
    seed: int
    most_s: float
    most_file_s: float
    workers: int
    out: str
    again: bool


def reach_of_all(asked: Asked) -> dict[str, FileReach]:
    """Return what each file of tests reaches; learn what is not known yet."""
    home, kept = Path.cwd(), Path(asked.out) / "reach"
    kept.mkdir(parents=True, exist_ok=True)
    files = [str(f) for folder in asked.tests for f in sorted(Path(folder).rglob("test_*.py"))]
    place = {file: kept / (file.replace("/", "+") + ".json") for file in files}
    known = {file: remembered(place[file], home) for file in files}

    def work(file: str) -> int:
        learn(file, asked.most_file_s, place[file])
        return 0

    unknown = [file for file, reach in known.items() if reach is None]
    children = [
        Child(file, partial(work, file), 3 * asked.most_file_s, place[file].with_suffix(".log"))
        for file in unknown
    ]
    for done, (child, code, took) in enumerate(run_all(children, asked.workers), 1):
        known[child.name] = remembered(place[child.name], home)
        told = "" if code == 0 else f" NOT LEARNED ({code}), see {child.log}"
        print(f"reach {done}/{len(children)} {child.name} {took:.0f} s{told}", flush=True)
    return {file: reach for file, reach in known.items() if reach is not None}


def drawn(asked: Asked) -> list[Mutant]:
    """Draw places of numeric code by seed, all alike, and at each one of its slips."""
    found = [
        slips
        for room in asked.rooms
        for path in (sorted(Path(room).rglob("*.py")) or [Path(room)])
        if is_numeric(path)
        for slips in places(str(path), path.read_bytes())
    ]
    generator = random.Random(asked.seed)
    generator.shuffle(found)
    return [generator.choice(slips) for slips in found[: asked.count]]


def untouched(mutant: Mutant) -> Mutant:
    """Return a mutant that changes nothing: its tests pass, or they tell nothing of any other."""
    source = Path(mutant.file).read_bytes()
    return replace(mutant, text=source[mutant.start : mutant.end].decode(), slip=CONTROL)


def tried(
    mutants: Sequence[Mutant], reached: dict[str, FileReach], asked: Asked
) -> Iterator[dict[str, object]]:
    """Try mutants; yield of each what became of it: killed, hung, survived, or never reached."""
    logs = Path(asked.out) / "logs"
    logs.mkdir(parents=True, exist_ok=True)
    plans, unreached = dict[str, dict[str, object]](), list[str]()

    def children() -> Iterator[Child]:
        for number, mutant in enumerate(mutants):
            lines = range(mutant.first_line, mutant.last_line + 1)
            chosen, cost_s = tests_reaching(mutant.file, lines, reached, asked.most_s)
            before, after = mutant.lines(Path(mutant.file).read_bytes())
            plans[mutant.name] = {
                **asdict(mutant), "name": mutant.name, "before": before, "after": after,
                "tests": len(chosen), "cost_s": round(cost_s, 1),
            }  # fmt: skip
            work: Callable[[], int] = partial(judge, mutant, chosen)
            if not chosen:
                work = nothing
                unreached.append(mutant.name)
            yield Child(mutant.name, work, READ_S + 5 * cost_s, logs / f"{number}.log")

    for child, code, took_s in run_all(children(), asked.workers):
        fate = {None: "hung", 0: "survived", BROKEN: "broken"}.get(code, "killed")
        fate = "unreached" if child.name in unreached else fate
        yield {**plans[child.name], "fate": fate, "took_s": round(took_s, 1), "code": code}


def nothing() -> int:
    """Do nothing: no test reaches the line."""
    return 0


def survivors(past: Iterable[dict[str, Any]]) -> list[Mutant]:
    """Return those that no test noticed, where their lines are still what they were."""
    found = []
    for each in past:
        if each["fate"] in SURVIVED:
            mutant = Mutant(**{name: each[name] for name in Mutant.__dataclass_fields__})
            if mutant.lines(Path(mutant.file).read_bytes())[0] == each["before"]:
                found.append(mutant)
    return found


def main(asked: Asked) -> int:
    """Do all of it but what is done already; return the exit code, 2 if a control did not pass."""
    read_libraries()
    reached = reach_of_all(asked)
    record = Path(asked.out) / f"seed-{asked.seed}.jsonl"
    lines = record.read_text().splitlines() if record.is_file() else []
    past = {each["name"]: each for each in map(json.loads, lines)}
    if asked.again:
        mutants = survivors(past.values())
    else:
        done = {name for name, each in past.items() if each["fate"] != "broken"}
        mutants = [mutant for mutant in drawn(asked) if mutant.name not in done]
    mixed = [
        each
        for number, mutant in enumerate(mutants)
        for each in ([untouched(mutant), mutant] if number % CONTROLS == 0 else [mutant])
    ]
    print(f"{len(mutants)} mutants to try, {len(past)} tried before", flush=True)
    worst = 0
    with record.open("a") as file:
        for each in tried(mixed, reached, asked):
            told = f"{each['fate']:9} {each['took_s']:5} s {each['file']}:{each['line']}"
            if each["slip"] == CONTROL:
                failed = each["fate"] not in SURVIVED
                worst = 2 if failed else worst
                print(f"control {'FAILED ' * failed}{told}", flush=True)
                continue
            file.write(json.dumps(each) + "\n")
            file.flush()
            print(f"{told}  {each['after']}", flush=True)
    return worst


if __name__ == "__main__":
    sys.exit(main(Asked(**json.loads(sys.argv[1]))))
