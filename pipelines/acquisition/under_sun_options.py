"""How thoroughly poses are looked for under a Sun that is known."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(frozen=True)
class Effort:
    """How many poses of one image are tried.

    Attributes
    ----------
    views : int
        How many of the likeliest under the Sun, and as many under an even light, are placed,
    held : int
        how many of the best placed are held against the light,
    laid : int
        how many of these are laid on the edges,
    twinned : int
        and of how many of these the twins are tried.
    polished : int
        How many of all of these are moved to where the light is likeliest, and laid anew: a small
        target's edges fit poses some degrees apart alike.
    """

    views: int = 90
    held: int = 40
    laid: int = 12
    twinned: int = 2
    polished: int = 4


@dataclass(frozen=True)
class UnderSunOptions:
    """How thoroughly to look.

    Attributes
    ----------
    fine_width : int, px
        Images wider than this are reduced.
    directions : int
        From how many the target is seen, before the first image.
    anew, quick : Effort
        Without a motion that images before allow, and with one.
    finalists : int
        How many poses are kept of an image.
    apart_deg, apart_share : float
        Poses further apart than this, or than this share of the range, are different.
    least_radius_px : float, px
        A target that seems smaller is not looked for.
    """

    fine_width: int = 1024
    directions: int = 500
    anew: Effort = field(default_factory=Effort)
    quick: Effort = field(default_factory=lambda: Effort(30, 16, 4, 1, 2))
    finalists: int = 6
    apart_deg: float = 8.0
    apart_share: float = 0.05
    least_radius_px: float = 12.0
