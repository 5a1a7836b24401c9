"""A table's values, each taken by its key and checked for its kind and range.

>>> fields = Fields({"frame": 3, "time_s": 0.6}, "estimates/best.jsonl:4")
>>> fields.whole("frame", 0, 1000), fields.number("time_s", 0.0, 1e9)
(3, 0.6)
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np

from models.arrays import Floats
from models.errors import DatasetError
from models.pose import RigidTransform
from models.reading.bounds import LENGTH_M, MOST_NAME
from models.reading.shown import is_plain, shown
from models.reading.uncertainty import exact_covariance, exact_rotation

MOST_ITEMS = 10_000_000  # of a list, where its reader names no other


class Fields:
    """A table that was read, and where from.

    Parameters
    ----------
    table : mapping
        As a parser of TOML or JSON gave it.
    where : Path or str
        The file, perhaps with its line, for messages.
    within : str
        The keys that led to this table, each with a dot after it.

    Raises
    ------
    DatasetError
        If the table is none; by every method, if a key or its value is not what was asked for.
    """

    def __init__(self, table: Mapping[str, Any], where: Path | str, within: str = "") -> None:
        self.where = where
        self._within = within
        if not isinstance(table, Mapping):
            name = within.rstrip(".") or "a table"
            raise DatasetError(f"{where}: expected {name} with keys and values, got {shown(table)}")
        self._table = table

    def __iter__(self) -> Iterator[str]:
        return iter(self._table)

    def __contains__(self, key: object) -> bool:
        return key in self._table

    def refusal(self, key: str, expected: str, came: Any) -> DatasetError:
        """Return the error that says what was expected of a key and what came.

        Parameters
        ----------
        key : str
        expected : str
            How it should have come: ``as a list``.
        came : object
            What came, as it is to be shown.
        """
        return DatasetError(f"{self.where}: expected {self._named(key)} {expected}, got {came}")

    def only(self, required: Collection[str], optional: Collection[str] = ()) -> None:
        """Refuse keys that are not known, and the lack of one that is required."""
        known = {*required, *optional}
        unknown = [shown(key)[1:-1] for key in self._table if key not in known][:10]
        missing = [key for key in required if key not in self._table]
        if unknown or missing:
            where = f" in {self._within.rstrip('.')}" if self._within else ""
            raise DatasetError(
                f"{self.where}: expected the keys {', '.join(sorted(known))}{where}; "
                f"unknown: {', '.join(unknown) or 'none'}; missing: {', '.join(missing) or 'none'}"
            )

    def names(self, most: int, most_characters: int = MOST_NAME) -> tuple[str, ...]:
        """Return all keys, where they may be any: printable, and not too many or too long."""
        name = self._within.rstrip(".") or "the table"
        if len(self._table) > most:
            raise DatasetError(
                f"{self.where}: expected {name} with up to {most} keys, got {len(self._table)}"
            )
        for key in self._table:
            if not (0 < len(key) <= most_characters and key.isprintable()):
                raise DatasetError(
                    f"{self.where}: expected the keys of {name} as printable text of 1 to "
                    f"{most_characters} characters, got {shown(key)}"
                )
        return tuple(self._table)

    def value(self, key: str) -> Any:
        """Return a value as it came."""
        if key not in self._table:
            raise DatasetError(f"{self.where}: expected the key {self._named(key)}, got none")
        return self._table[key]

    def number(
        self, key: str, low: float, high: float, *, above: float | None = None, unit: str = ""
    ) -> float:
        """Return a number from ``low`` to ``high``, and greater than ``above`` if that is given.

        Parameters
        ----------
        key : str
        low, high : float
            Both allowed.
        above : float, optional
            Not itself allowed.
        unit : str
            For the message.
        """
        came = self._number(key)
        if not (low <= came <= high and (above is None or came > above)):
            raise self.refusal(key, _between(low, high, above, unit), shown(came))
        return float(came)

    def whole(self, key: str, low: int, high: int) -> int:
        """Return a whole number from ``low`` to ``high``; 2.0 is none.

        Parameters
        ----------
        key : str
        low, high : int
            Both allowed.
        """
        came = self._whole(key)
        if not low <= came <= high:
            raise self.refusal(key, _between(low, high, None, ""), shown(came))
        return came

    def flag(self, key: str) -> bool:
        """Return true or false."""
        came = self.value(key)
        if not isinstance(came, bool):
            raise self.refusal(key, "as true or false", shown(came))
        return came

    def text(self, key: str, most_characters: int = MOST_NAME, *, lines: bool = False) -> str:
        """Return printable text.

        Parameters
        ----------
        key : str
        most_characters : int
        lines : bool
            Whether it may have several lines.
        """
        return self._text(key, self.value(key), most_characters, lines)

    def choice(self, key: str, among: Collection[str]) -> str:
        """Return one of a few words."""
        came = self.value(key)
        if not isinstance(came, str) or came not in among:
            raise self.refusal(key, f"as one of {', '.join(among)}", shown(came))
        return came

    def items(self, key: str, most: int = MOST_ITEMS) -> list[Any]:
        """Return a list as it came."""
        came = self.value(key)
        if not isinstance(came, list) or len(came) > most:
            expected = "as a list" if not isinstance(came, list) else f"as a list of up to {most}"
            what = f"{len(came)} items" if isinstance(came, list) else shown(came)
            raise self.refusal(key, expected, what)
        return came

    def wholes(self, key: str, low: int, high: int, most: int = MOST_ITEMS) -> tuple[int, ...]:
        """Return a list of whole numbers.

        Parameters
        ----------
        key : str
        low, high : int
            Of each; both allowed.
        most : int
            Of items.
        """
        came = self.items(key, most)
        for item in came:
            if type(item) is not int or not low <= item <= high:
                raise self.refusal(key, f"as whole numbers of {low} to {high}", shown(item))
        return tuple(came)

    def flags(self, key: str, most: int = MOST_ITEMS) -> tuple[bool, ...]:
        """Return a list of true and false."""
        came = self.items(key, most)
        for item in came:
            if not isinstance(item, bool):
                raise self.refusal(key, "as a list of true and false", shown(item))
        return tuple(came)

    def texts(
        self, key: str, most: int = MOST_ITEMS, most_characters: int = MOST_NAME
    ) -> tuple[str, ...]:
        """Return a list of printable texts of one line each.

        Parameters
        ----------
        key : str
        most : int
            Of items.
        most_characters : int
            Of each.
        """
        came = self.items(key, most)
        return tuple(self._text(key, item, most_characters, False) for item in came)

    def vector(self, key: str, length: int | None, low: float, high: float) -> Floats:
        """Return a list of numbers.

        Parameters
        ----------
        key : str
        length : int or None
            Any number of them if it is None.
        low, high : float
            Of each; both allowed.

        Returns
        -------
        (length,) array
        """
        return self.numbers(key, (length,), low, high)

    def numbers(
        self,
        key: str,
        shape: Sequence[int | None],
        low: float,
        high: float,
        most: int = MOST_ITEMS,
        *,
        holes: bool = False,
    ) -> Floats:
        """Return an array of nested lists.

        Parameters
        ----------
        key : str
        shape : sequence of int or None
            Only the first may be None, any length.
        low, high : float
            Of each number; both allowed.
        most : int
            Of items, in any one list.
        holes : bool
            Whether a null is a NaN, or refused.

        Returns
        -------
        (...,) array
            Of the shape asked for.
        """
        rows: list[Any] = [self.value(key)]
        words = " x ".join("n" if side is None else str(side) for side in shape)
        for side in shape:
            for row in rows:
                if not isinstance(row, list) or len(row) > most or side not in (None, len(row)):
                    raise self.refusal(key, f"as lists of {words} numbers", shown(row))
            rows = list(chain.from_iterable(rows))
        for item in rows:
            if item is None and holes:
                continue
            if type(item) not in (int, float) or not low <= item <= high:
                expected = f"as numbers {_between(low, high, None, '')}"
                raise self.refusal(key, expected, shown(item))
        sides = [-1 if side is None else side for side in shape]
        return np.array(rows, dtype=np.float64).reshape(sides)

    def array(self, key: str, low: float, high: float, most: int = MOST_ITEMS) -> Floats:
        """Return numbers nested in lists, of any shape in which every depth has one length.

        Parameters
        ----------
        key : str
        low, high : float
            Of each number; both allowed.
        most : int
            Of items, at every depth.

        Returns
        -------
        (...,) array
            Of shape () where there is but one number, and no list.
        """
        rows: list[Any] = [self.value(key)]
        sides: list[int] = []
        while rows and all(isinstance(row, list) for row in rows):
            lengths = {len(row) for row in rows}
            if len(lengths) > 1 or len(rows) * max(lengths) > most:
                what = f"as up to {most} numbers in lists of one length"
                raise self.refusal(key, what, shown(self.value(key)))
            sides.append(lengths.pop())
            rows = list(chain.from_iterable(rows))
        for item in rows:
            if type(item) not in (int, float) or not low <= item <= high:
                expected = f"as numbers {_between(low, high, None, '')}"
                raise self.refusal(key, expected, shown(item))
        return np.array(rows, dtype=np.float64).reshape(sides)

    def rotation(self, key: str) -> Floats:
        """Return a (3, 3) rotation matrix, made exact if it was typed with six digits or more."""
        came = self.numbers(key, (3, 3), -2.0, 2.0)
        try:
            return exact_rotation(came)
        except ValueError as error:
            raise self.refusal(key, "as a rotation matrix", str(error)) from error

    def pose(
        self, rotation_key: str, translation_key: str, low: float, high: float
    ) -> RigidTransform:
        """Return a pose from its rotation and its translation.

        Parameters
        ----------
        rotation_key, translation_key : str
        low, high : float, m
            Of each number of the translation; both allowed.
        """
        return RigidTransform(
            self.rotation(rotation_key), self.vector(translation_key, 3, low, high)
        )

    def covariance(self, key: str, size: int, most: float = LENGTH_M[1] ** 2) -> Floats:
        """Return a covariance, exactly symmetric.

        Parameters
        ----------
        key : str
        size : int
        most : float
            No entry is larger, nor less than minus this.

        Returns
        -------
        (size, size) array
        """
        came = self.numbers(key, (size, size), -most, most)
        try:
            return exact_covariance(came)
        except ValueError as error:
            raise self.refusal(key, "as a covariance", str(error)) from error

    def table(self, key: str) -> Fields:
        """Return an inner table."""
        return Fields(self.value(key), self.where, f"{self._within}{key}.")

    def tables(self, key: str, most: int = MOST_ITEMS) -> list[Fields]:
        """Return a list of inner tables."""
        return [
            Fields(item, self.where, f"{self._within}{key}.{number}.")
            for number, item in enumerate(self.items(key, most))
        ]

    def _named(self, key: str) -> str:
        return f"{self._within}{key}"

    def _number(self, key: str) -> int | float:
        came = self.value(key)
        if type(came) not in (int, float):
            raise self.refusal(key, "to be a number", shown(came))
        return came

    def _whole(self, key: str) -> int:
        came = self.value(key)
        if type(came) is not int:
            raise self.refusal(key, "to be a whole number", shown(came))
        return came

    def _text(self, key: str, came: Any, most_characters: int, lines: bool) -> str:
        if not isinstance(came, str):
            raise self.refusal(key, "to be text", shown(came))
        if len(came) > most_characters:
            expected = f"of at most {most_characters} characters"
            raise self.refusal(key, expected, f"{len(came)}")
        if not is_plain(came, lines=lines):
            raise self.refusal(key, "to be printable text", shown(came))
        return came


def _between(low: float, high: float, above: float | None, unit: str) -> str:
    unit = f" {unit}" if unit else ""
    least = f"above {above:g}" if above is not None and above >= low else f"of at least {low:g}"
    return f"{least} and at most {high:g}{unit}"
