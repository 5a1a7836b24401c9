"""Numbers as text: three significant digits, a true minus sign, a dash for none."""

from __future__ import annotations

import math

NONE = "–"
MINUS = "\N{MINUS SIGN}"
SMALLEST = 1e-5  # that is written without an exponent


def number(value: float | None, digits: int = 3, signed: bool = False) -> str:
    """Write a number with so many significant digits; 0 stands for nothing else.

    Only what is below 1e-5 has an exponent: 2.61e-6, with a true minus.

    Parameters
    ----------
    value : float or None
    digits : int
        Significant digits; a number of thousands keeps all before the point.
    signed : bool
        Whether a positive number gets its sign too.
    """
    if value is None:
        return NONE
    if value == 0.0:
        return "0"
    if abs(value) < SMALLEST:
        mantissa, exponent = f"{value:{'+' if signed else ''}.{digits - 1}e}".split("e")
        return f"{mantissa}e{int(exponent)}".replace("-", MINUS)
    rounded = float(f"{value:.{digits - 1}e}")  # 0.9999 is 1.00, not 1.000
    decimals = max(0, digits - 1 - math.floor(math.log10(abs(rounded))))
    text = f"{value:+.{decimals}f}" if signed else f"{value:.{decimals}f}"
    return text.replace("-", MINUS)


def count(value: int) -> str:
    """Write a whole number."""
    return f"{value:d}"


def numbers(values: list[float] | None, digits: int = 3, signed: bool = False) -> list[str]:
    """Write three numbers, or three dashes.

    Parameters
    ----------
    values : list of 3 floats, or None
    digits, signed : as for ``number``
    """
    if values is None:
        return [NONE] * 3
    return [number(value, digits, signed) for value in values]


def share(value: float | None) -> str:
    """Write a share of one in percent: three digits, four where three would say all."""
    if value is None:
        return NONE
    if value == 1.0:
        return "100 %"
    return f"{number(100.0 * value, 4 if 0.995 <= value < 1.0 else 3)} %"
