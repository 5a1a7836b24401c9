"""``rvbench``, the command line: parse, run a verb, turn what went wrong into one message.

Exit codes: 0 done, 1 worse than asked, 2 could not run, 130 interrupted, 141 who read what we print
has left.
"""

from __future__ import annotations

import difflib
import inspect
import io
import os
import re
import sys
import traceback
from collections.abc import Sequence
from platform import python_version
from typing import Annotated, Any, NoReturn, Union

import tyro

from bench import verbs
from bench.compare.verb import Compare
from bench.export.verb import Export
from bench.fusing.verb import Fuse
from bench.inspecting.verb import Inspect
from bench.interrupts import INTERRUPTED, leave, prompt_interrupts, told
from bench.new.verb import New
from bench.random_dataset.verb import Dataset
from bench.runners.cancel_verb import Cancel
from bench.scoring.verb import Score
from bench.status.verb import Status
from bench.store.verb import Store
from bench.suites.verb import Suite
from bench.sweep.verb import Sweep
from bench.viewing.verb import View
from models.errors import RvbenchError, ScenarioError
from models.reading.shown import shown

COULD_NOT_RUN, NOBODY_READS = 2, 141
MOST_MESSAGE = 2000  # characters
CONTROLS = re.compile(r"[\x00-\x1f\x7f-\x9f]")

VERBS: dict[str, type[Any]] = {
    "run": verbs.Run,
    "render": verbs.Render,
    "sweep": Sweep,
    "dataset": Dataset,
    "suite": Suite,
    "estimate": verbs.Estimate,
    "score": Score,
    "fuse": Fuse,
    "compare": Compare,
    "report": verbs.Report,
    "view": View,
    "show": verbs.Show,
    "inspect": Inspect,
    "export": Export,
    "cancel": Cancel,
    "status": Status,
    "store": Store,
    "new": New,
    "list": verbs.List,
    "doctor": verbs.Doctor,
}
DESCRIPTION = """The bench on which spacecraft vision-based navigation is tried before it flies.

    rvbench list
    rvbench run maxar-demo --out out/demo
    rvbench show out/demo 0
    rvbench run --help

Exit codes: 0 done, 1 worse than asked, 2 could not run.

`rvbench --version` tells versions. In bash, for completion with the tab key:
    rvbench --tyro-print-completion bash > ~/.local/share/bash-completion/completions/rvbench
(zsh and tcsh alike). Without the script: `python -m bench` in a clone does what `rvbench` does."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code.

    Parameters
    ----------
    arguments : sequence of str, optional
        What follows ``rvbench``; ``sys.argv`` unless given. Only then does Ctrl-C end the whole
        process, and so does the verb when it is done, see ``bench.interrupts``.
    """
    return _run_and_leave(sys.argv[1:]) if arguments is None else _run(list(arguments))


def _run_and_leave(typed: list[str]) -> NoReturn:
    """Run a verb as all that this process is for."""
    with prompt_interrupts(typed[0] if typed else ""):
        leave(_run(typed))


def _run(typed: list[str]) -> int:
    """Parse and run; return the exit code."""
    verb = typed[0] if typed else ""
    _print_any_name()
    try:
        code = int(parse(typed).run())
        if sys.stdout is not None:
            sys.stdout.flush()  # now, while somebody can be told
        return code
    except SystemExit as stop:  # help was printed, or the arguments could not be read
        if _lies_beneath(BrokenPipeError, stop):  # as rich ends a process
            return _nobody_reads()
        if stop.code is None:  # a completion script was printed
            return 0
        return stop.code if isinstance(stop.code, int) else COULD_NOT_RUN
    except BrokenPipeError:
        return _nobody_reads()
    except RvbenchError as error:
        print(f"rvbench: {_readable(str(error))}", file=sys.stderr)
        return COULD_NOT_RUN
    except KeyboardInterrupt:
        return _interrupted(verb)
    except OSError as error:
        return _not_let(error)
    except Exception as error:
        if isinstance(error, RuntimeError) and "Symlink loop" in str(error):  # of Path.resolve
            return _not_let(error)
        if _lies_beneath(KeyboardInterrupt, error):  # Dr.Jit's loops wrap it in one of their own
            return _interrupted(verb)
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
        After printing help, versions, or what is wrong and what was perhaps meant.
    ScenarioError
        If there is no such verb, or an argument is empty or has control characters.
    """
    _refuse_empty(arguments)
    _refuse_controls(arguments)
    if arguments and arguments[0] in VERBS:
        name, verb = arguments[0], VERBS[arguments[0]]
        explained = inspect.cleandoc(verb.__doc__ or "")
        return tyro.cli(verb, prog=f"rvbench {name}", description=explained, args=arguments[1:])
    if arguments == ["--version"]:
        print(versions())
        raise SystemExit(0)
    if arguments and not arguments[0].startswith("-"):
        near = difflib.get_close_matches(arguments[0], VERBS, n=1)
        hint = f"; perhaps you meant {near[0]}" if near else ""
        raise ScenarioError(f"expected one of {', '.join(VERBS)}, got {shown(arguments[0])}{hint}")
    choices = tuple(
        Annotated[verb, tyro.conf.subcommand(name, description=_first_line(verb))]
        for name, verb in VERBS.items()
    )
    asked = Union[choices]  # type: ignore[valid-type]  # noqa: UP007
    return tyro.cli(asked, prog="rvbench", description=DESCRIPTION, args=arguments)


def versions() -> str:
    """Return what runs here, in a line; `rvbench doctor` tells more."""
    from importlib.metadata import version

    return (
        f"rvbench {version('rvbench')}, Python {python_version()}, Mitsuba {version('mitsuba')}, "
        f"Dr.Jit {version('drjit')}"
    )


def _refuse_empty(arguments: list[str]) -> None:
    """Refuse an empty argument: as a folder it would mean the one where the user happens to be."""
    for place, argument in enumerate(arguments):
        option, is_given, value = argument.partition("=")
        if not argument.strip() or (option.startswith("--") and is_given and not value.strip()):
            before = arguments[place - 1] if place else ""
            after = option if is_given else before if before.startswith("--") else ""
            where = f" after {after}" if after else ""
            raise ScenarioError(f"expected a value{where}, got an empty text")


def _refuse_controls(arguments: list[str]) -> None:
    """Refuse control characters: whoever tells of them again has the terminal obey them."""
    for argument in arguments:
        if CONTROLS.search(argument):
            raise ScenarioError(
                f"expected arguments without control characters, got {shown(argument)}"
            )


def _readable(message: str) -> str:
    """Return a message that a terminal shows and does not obey, of a length that is still read."""
    if len(message) > MOST_MESSAGE:
        half = MOST_MESSAGE // 2
        message = f"{message[:half]} ... {message[-half:]}"
    return CONTROLS.sub(lambda found: ascii(found[0])[1:-1], message)


def _print_any_name() -> None:
    """Have names of files that are no UTF-8 printed with their bytes escaped, not raise."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")


def _interrupted(verb: str) -> int:
    print(told(verb), file=sys.stderr)
    return INTERRUPTED


def _nobody_reads() -> int:
    """Let nothing more be written where nobody reads, and say so in the way of a shell."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except BrokenPipeError:
            os.dup2(nowhere, stream.fileno())
    os.close(nowhere)
    return NOBODY_READS


def _not_let(error: Exception) -> int:
    """Say what the system refuses."""
    print(
        "rvbench: expected the system to let us read and write, got: "
        f"{_readable(str(error))}; every file written so far is whole and kept",
        file=sys.stderr,
    )
    return COULD_NOT_RUN


def _lies_beneath(kind: type[BaseException], error: BaseException | None) -> bool:
    """Tell whether an exception of a kind is what an error was raised from, or because of."""
    while error is not None and not isinstance(error, kind):
        error = error.__cause__ or error.__context__
    return error is not None


def _first_line(verb: type[Any]) -> str:
    return (verb.__doc__ or "").splitlines()[0]


if __name__ == "__main__":
    sys.exit(main())
