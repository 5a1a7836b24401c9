"""An inertia up to its scale as five free numbers: every five of them are the inertia of a body.

What can turn is a spread of mass, ``S = integral of x x' dm``, which is symmetric and positive
definite, and of which the inertia is ``tr(S) 1 - S``: positive moments and the triangle inequality
follow. S is written as ``L L'``, L lower triangular of determinant 1, and the trace of the inertia
is set to 1, for its scale moves nothing that can be seen. The chart: the logarithms of L's first
two diagonal entries, then its entries (2, 1), (3, 1), (3, 2).
"""

from __future__ import annotations

import numpy as np

from models.arrays import Floats

SIZE = 5
_ROWS, _COLUMNS = np.array([1, 2, 2]), np.array([0, 0, 1])


def inertia_of(chart: Floats) -> Floats:
    """Return the (3, 3) inertia of trace 1 of a (5,) chart."""
    root = _root(chart)
    spread = root @ root.T
    return np.eye(3) * 0.5 - 0.5 * spread / np.trace(spread)


def derivatives(chart: Floats) -> Floats:
    """Return (5, 3, 3): the inertia's derivative by each number of a (5,) chart."""
    root = _root(chart)
    spread = root @ root.T
    trace = float(np.trace(spread))
    changes = np.zeros((SIZE, 3, 3))
    changes[0, 0, 0], changes[1, 1, 1] = root[0, 0], root[1, 1]
    changes[:2, 2, 2] = -root[2, 2]
    changes[np.arange(2, SIZE), _ROWS, _COLUMNS] = 1.0
    by_spread = changes @ root.T + root @ changes.transpose(0, 2, 1)
    traces = np.trace(by_spread, axis1=1, axis2=2)[:, None, None]
    return -0.5 * (by_spread / trace - spread * traces / trace**2)


def chart_of(inertia: Floats) -> Floats:
    """Return the (5,) chart of a (3, 3) inertia of any scale.

    Raises
    ------
    ValueError
        If no body has it.
    """
    spread = 0.5 * np.trace(inertia) * np.eye(3) - inertia
    try:
        root = np.linalg.cholesky(spread)
    except np.linalg.LinAlgError as error:
        raise ValueError(
            f"expected the inertia of a body that is no disc, got {inertia.tolist()}"
        ) from error
    root /= np.prod(np.diag(root)) ** (1.0 / 3.0)
    return np.concatenate([np.log(np.diag(root)[:2]), root[_ROWS, _COLUMNS]])


def _root(chart: Floats) -> Floats:
    root = np.diag(np.exp([chart[0], chart[1], -chart[0] - chart[1]]))
    root[_ROWS, _COLUMNS] = chart[2:]
    return root
