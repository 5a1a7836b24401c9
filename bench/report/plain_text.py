"""Text of a figure as it was typed: a name may hold a `$`, which matplotlib takes for a formula."""

from __future__ import annotations

from matplotlib.figure import Figure
from matplotlib.text import Text


def take_literally(figure: Figure) -> None:
    """Have a finished figure show every text as it is, but for the numbers of its axes.

    Those of a logarithmic axis are formulas of matplotlib's own.
    """
    axes = [axis for panel in figure.axes for axis in (panel.xaxis, panel.yaxis)]
    own = {
        id(text) for axis in axes for text in axis.findobj(Text) if text is not axis.label
    }  # findobj makes no new ticks: what is drawn later parses as usual
    for text in figure.findobj(Text):
        if isinstance(text, Text) and id(text) not in own:
            text.set_parse_math(False)
