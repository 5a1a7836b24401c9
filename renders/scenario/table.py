"""What every table of a scenario is: frozen, strict about its keys, and about kinds of values.

A whole number may stand for any number, and a list for a tuple, as TOML writes them; no text for a
number, nor true for one.
"""

from __future__ import annotations

from typing import Annotated

from pydantic import AfterValidator, BaseModel, ConfigDict, Field
from pydantic_core import PydanticCustomError

from models.reading.bounds import MOST_NAME, MOST_PROSE
from models.reading.shown import is_plain, reads_as_written


class Table(BaseModel):
    """A frozen table of a scenario; an unknown key is an error."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)


def _printable(text: str) -> str:
    if not is_plain(text, lines=True) or not reads_as_written(text):
        raise PydanticCustomError("not_printable", "it has characters that cannot be printed")
    return text


def _on_one_line(text: str) -> str:
    if not is_plain(text) or not reads_as_written(text) or not text.strip():
        raise PydanticCustomError("not_a_name", "it is no printable text on one line")
    return text


Name = Annotated[str, Field(max_length=MOST_NAME), AfterValidator(_on_one_line)]
Prose = Annotated[str, Field(max_length=MOST_PROSE), AfterValidator(_printable)]

Component = Annotated[float, Field(ge=-1e6, le=1e6)]  # of a vector, whatever its unit
Triple = Annotated[tuple[Component, Component, Component], Field(strict=False)]
Numbers = Annotated[tuple[Component, ...], Field(strict=False, max_length=4)]
