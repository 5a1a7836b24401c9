"""CSV tables with a header: each row as long as it, each number strictly a number."""

from __future__ import annotations

import csv
import re
from collections.abc import Collection, Iterable, Sequence
from pathlib import Path

from models.errors import UnreadableError
from models.reading.fields import Fields
from models.reading.regular_file import MOST_TABLE_BYTES, read_lines
from models.reading.shown import shown, shown_line

MOST_ROW_CHARACTERS = 100_000

_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,4})?", re.ASCII)
_WHOLE = re.compile(r"[+-]?\d{1,18}", re.ASCII)


class CsvRow(Fields):
    """A row, by column; an empty cell is text of no characters."""

    def empty(self, key: str) -> bool:
        """Tell whether a cell is empty."""
        return self.value(key) == ""

    def flag(self, key: str) -> bool:
        """Return true or false, typed as either of ``true``, ``True``."""
        came = self.value(key)
        if came not in ("true", "True", "false", "False"):
            raise self.refusal(key, "as true or false", shown(came))
        return bool(came in ("true", "True"))

    def _number(self, key: str) -> int | float:
        came = self.value(key)
        if len(came) > 100 or not _NUMBER.fullmatch(came):
            raise self.refusal(key, "to be a number", shown(came))
        return float(came)

    def _whole(self, key: str) -> int:
        came = self.value(key)
        if not _WHOLE.fullmatch(came):
            raise self.refusal(key, "to be a whole number", shown(came))
        return int(came)


def read_csv(
    path: Path,
    columns: Sequence[str],
    optional: Collection[str] = (),
    most_bytes: int = MOST_TABLE_BYTES,
) -> list[CsvRow]:
    """Read a table with a header.

    Parameters
    ----------
    path : Path
    columns : sequence of str
        That must be there, in any order.
    optional : collection of str
        That may be; any other is refused.
    most_bytes : int

    Raises
    ------
    UnreadableError
        If it is no regular file, too large, no UTF-8, without that header, or has a row of another
        length.
    """
    return csv_rows(read_lines(path, most_bytes, MOST_ROW_CHARACTERS), path, columns, optional)


def csv_rows(
    lines: Iterable[str],
    where: Path | str,
    columns: Sequence[str],
    optional: Collection[str] = (),
) -> list[CsvRow]:
    """Return the rows of a table whose lines are at hand, its header first; see ``read_csv``.

    Parameters
    ----------
    lines : iterable of str
    where : Path or str
        Where they stand, for messages.
    columns, optional : collections of str

    Raises
    ------
    UnreadableError
        If the header is another, or a row is of another length.
    """
    reader = csv.reader((line + "\n" for line in lines), strict=True)  # a cell may have lines
    try:
        header = next(reader, [])
        _check_header(where, header, columns, optional)
        rows = []
        for cells in reader:
            if len(cells) != len(header):
                raise UnreadableError(
                    where, f"expected {len(header)} cells, got {len(cells)}", reader.line_num
                )
            rows.append(CsvRow(dict(zip(header, cells, strict=True)), f"{where}:{reader.line_num}"))
    except csv.Error as error:
        raise UnreadableError(where, shown_line(str(error)), reader.line_num) from error
    return rows


def _check_header(
    where: Path | str, header: Sequence[str], columns: Sequence[str], optional: Collection[str]
) -> None:
    missing = [name for name in columns if name not in header]
    known = {*columns, *optional}
    unknown = [shown(name) for name in header if name not in known]
    twice = [name for name in known if header.count(name) > 1]
    if missing or unknown or twice:
        raise UnreadableError(
            where,
            f"expected the columns {', '.join(columns)}; missing: {', '.join(missing) or 'none'}; "
            f"unknown: {', '.join(unknown[:10]) or 'none'}; twice: {', '.join(twice) or 'none'}",
            1,
        )
