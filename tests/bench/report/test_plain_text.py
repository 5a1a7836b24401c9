"""A `$` in a name starts no formula; the numbers of a logarithmic axis are formulas still."""

from __future__ import annotations

import io

import numpy as np
import pytest
from matplotlib.figure import Figure

from bench.report.plain_text import take_literally

NOT_A_FORMULA = r"$\frac{$"


def drawn(scale: str) -> Figure:
    figure = Figure(layout="constrained")
    panel = figure.subplots()
    panel.plot([1.0, 2.0], [1e-3, 1e3], label=NOT_A_FORMULA)
    panel.set_yscale(scale)
    panel.set_title(NOT_A_FORMULA)
    panel.set_xlabel(NOT_A_FORMULA)
    panel.annotate(NOT_A_FORMULA, (1.0, 1.0))
    figure.legend()
    figure.text(0.1, 0.1, NOT_A_FORMULA)
    return figure


def saved(figure: Figure) -> bytes:
    stream = io.BytesIO()
    figure.savefig(stream, format="raw", dpi=40)
    return stream.getvalue()


def test_without_it_a_name_breaks_the_figure() -> None:
    with pytest.raises(ValueError, match="frac"):
        saved(drawn("linear"))


@pytest.mark.parametrize("scale", ["linear", "log"])
def test_every_text_is_taken_literally(scale: str) -> None:
    figure = drawn(scale)
    take_literally(figure)
    assert saved(figure)


def test_the_powers_of_ten_of_an_axis_stay_formulas() -> None:
    plain, literal = Figure(), Figure()
    for figure in (plain, literal):
        figure.subplots().semilogy([1.0, 2.0], [1e-3, 1e3])
    take_literally(literal)
    assert np.array_equal(saved(plain), saved(literal))
