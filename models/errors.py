"""The few exceptions of the house. Each says what was expected, what came, and what to do.

The command line turns any of them into one message and exit code 2. Failure to find a pose is
not here: it is a value, a ``models.estimate.Estimate`` with its reason.
"""

from __future__ import annotations


class RvbenchError(Exception):
    """Something that its reader can mend; the message says how."""


class ScenarioError(RvbenchError):
    """A scenario, camera or option that cannot be used as it stands."""


class DatasetError(RvbenchError):
    """A dataset folder that is missing, truncated, of another version or inconsistent."""


class UnreadableError(DatasetError):
    """A file that is no regular file, too large, no text, or not of its format.

    Attributes
    ----------
    reason : str
        What is wrong, without the path and the line.
    told : str
        Without the path.
    line : int, optional
        Where, if a line can be named.
    """

    def __init__(self, path: object, told: str, line: int | None = None) -> None:
        super().__init__(f"{path}: {told}" if line is None else f"{path}:{line}: {told}")
        self.reason = told
        self.told = told if line is None else f"in line {line}: {told}"
        self.line = line
        self._made_of = (str(path), told, line)

    def __reduce__(self) -> tuple[type[UnreadableError], tuple[str, str, int | None]]:
        """Let it come out of another process as it went in."""
        return type(self), self._made_of


class VariantError(RvbenchError):
    """No Mitsuba variant that renders on this machine."""


class StorageError(RvbenchError):
    """A disk that is full or cannot be written."""


class RunnerError(RvbenchError):
    """A cluster that is not there, does not take a job, or does not do it."""


def cause(error: Exception) -> str:
    """Return what the system or a parser said, without the path that our message names already."""
    if isinstance(error, KeyError):
        return f"no {error.args[0]}"
    if isinstance(error, UnreadableError):
        return error.told
    return str(getattr(error, "strerror", None) or error)
