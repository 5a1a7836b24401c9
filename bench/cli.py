"""``rvbench``, the command line: parse, run a verb, turn what went wrong into one message.

Exit codes: 0 done, 1 worse than asked, 2 could not run, 130 interrupted.
"""

from __future__ import annotations

import inspect
import sys
import traceback
from collections.abc import Sequence
from typing import Annotated, Any, Union

import tyro

from bench import verbs
from bench.store.verb import Store
from bench.suites.verb import Suite
from bench.sweep.verb import Sweep
from models.errors import RvbenchError

COULD_NOT_RUN, INTERRUPTED = 2, 130

VERBS: dict[str, type[Any]] = {
    "run": verbs.Run,
    "render": verbs.Render,
    "sweep": Sweep,
    "suite": Suite,
    "estimate": verbs.Estimate,
    "score": verbs.Score,
    "report": verbs.Report,
    "show": verbs.Show,
    "store": Store,
    "list": verbs.List,
    "doctor": verbs.Doctor,
}
DESCRIPTION = """The bench on which spacecraft vision-based navigation is tried before it flies.

    rvbench list
    rvbench run maxar-demo --out out/demo
    rvbench show out/demo 0
    rvbench run --help

Exit codes: 0 done, 1 worse than asked, 2 could not run."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code.

    Parameters
    ----------
    arguments : sequence of str, optional
        What follows ``rvbench``; ``sys.argv`` unless given.
    """
    try:
        verb = parse(list(sys.argv[1:] if arguments is None else arguments))
        return int(verb.run())
    except SystemExit as stop:  # help was printed, or the arguments could not be read
        return stop.code if isinstance(stop.code, int) else COULD_NOT_RUN
    except RvbenchError as error:
        print(f"rvbench: {error}", file=sys.stderr)
        return COULD_NOT_RUN
    except KeyboardInterrupt:
        return _interrupted()
    except OSError as error:
        print(
            f"rvbench: expected the system to let us read and write, got: {error}; every file "
            "written so far is whole and kept",
            file=sys.stderr,
        )
        return COULD_NOT_RUN
    except Exception as error:
        if _is_an_interrupt(error):
            return _interrupted()
        traceback.print_exc()
        print(
            "rvbench: this is a fault of rvbench itself; please report it with the lines above "
            "and what `rvbench doctor` prints",
            file=sys.stderr,
        )
        return COULD_NOT_RUN


def parse(arguments: list[str]) -> Any:
    """Return the verb that the arguments ask for, with its options; see ``bench.verbs``.

    Raises
    ------
    SystemExit
        After printing help, or what is wrong and what was perhaps meant.
    """
    if arguments and arguments[0] in VERBS:
        name, verb = arguments[0], VERBS[arguments[0]]
        told = inspect.cleandoc(verb.__doc__ or "")
        return tyro.cli(verb, prog=f"rvbench {name}", description=told, args=arguments[1:])
    choices = tuple(
        Annotated[verb, tyro.conf.subcommand(name, description=_first_line(verb))]
        for name, verb in VERBS.items()
    )
    asked = Union[choices]  # type: ignore[valid-type]  # noqa: UP007
    return tyro.cli(asked, prog="rvbench", description=DESCRIPTION, args=arguments)


def _interrupted() -> int:
    print(
        "rvbench: interrupted; every file written so far is whole and kept, "
        "and the same command goes on from there",
        file=sys.stderr,
    )
    return INTERRUPTED


def _is_an_interrupt(error: BaseException | None) -> bool:
    """Tell whether Ctrl-C lies beneath an error: Dr.Jit's loops wrap it in one of their own."""
    while error is not None and not isinstance(error, KeyboardInterrupt):
        error = error.__cause__
    return error is not None


def _first_line(verb: type[Any]) -> str:
    return (verb.__doc__ or "").splitlines()[0]


if __name__ == "__main__":
    sys.exit(main())
