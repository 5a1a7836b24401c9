"""Masks as run lengths, as COCO counts them: column by column, beginning with the zeros."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from models.arrays import Mask

CHUNK_BITS, MORE, SIGN, FIRST_CHARACTER = 5, 0x20, 0x10, 48


def run_lengths(mask: Mask) -> list[int]:
    """Return the lengths of the runs of a (height, width) mask, zeros first, in column order."""
    pixels = np.asarray(mask, dtype=np.bool_).ravel(order="F")
    if not pixels.size:
        return []
    edges = np.flatnonzero(pixels[1:] != pixels[:-1]) + 1
    lengths = np.diff(np.concatenate([[0], edges, [pixels.size]]))
    return ([0] if pixels[0] else []) + [int(length) for length in lengths]


def mask_of(lengths: Sequence[int], height: int, width: int) -> Mask:
    """Return the mask of some run lengths, (height, width).

    Parameters
    ----------
    lengths : sequence of int
    height, width : int, px

    Raises
    ------
    ValueError
        If they are not those of a mask of that size.
    """
    if any(length < 0 for length in lengths) or sum(lengths) != height * width:
        raise ValueError(
            f"expected run lengths that add up to {height} x {width} pixels, got {sum(lengths)}"
        )
    values = np.arange(len(lengths)) % 2 == 1
    return np.repeat(values, lengths).reshape((height, width), order="F")


def packed(lengths: Sequence[int]) -> str:
    """Return run lengths as the short text of COCO's own tools.

    From the third on each length is told as its difference from the one two before; numbers are
    written in groups of five bits, lowest first, a sixth bit saying whether more follow
    (Lin et al., the COCO API, 2014).
    """
    characters: list[str] = []
    for place, length in enumerate(lengths):
        left = length - lengths[place - 2] if place > 2 else length
        while True:
            bits = left & (MORE - 1)
            left >>= CHUNK_BITS
            done = left == (-1 if bits & SIGN else 0)
            characters.append(chr((bits if done else bits | MORE) + FIRST_CHARACTER))
            if done:
                break
    return "".join(characters)
