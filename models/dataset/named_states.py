"""The states in a line of an estimates file: any names and shapes, those of the house checked."""

from __future__ import annotations

from typing import Any

import numpy as np

from models.estimate import NamedState
from models.motion.relative_state import STATE_COVARIANCE_SHAPE, STATE_SHAPES
from models.reading.bounds import MOST_NAME
from models.reading.fields import Fields
from models.reading.shown import shown
from models.reading.uncertainty import exact_covariance, exact_rotation

MOST_STATES, MOST_VALUES = 100, 1000
MOST_NUMBERS = 1_000_000  # of one value: the covariance of a thousand
LARGEST = 1e15


def state_to_json(state: NamedState) -> dict[str, Any]:
    """Return one state as a JSON object."""
    record: dict[str, Any] = {
        "values": {name: np.asarray(each).tolist() for name, each in state.values.items()}
    }
    if state.covariance is not None:
        record["covariance"] = np.asarray(state.covariance).tolist()
    return record


def read_states(fields: Fields) -> dict[str, NamedState]:
    """Read states by name.

    Raises
    ------
    DatasetError
        If a name is no printable text, a value is not of numbers, one that begins with ``R_`` is
        no rotation, a covariance is none, or a state of ``models.motion.relative_state`` has not
        its values and shapes.
    """
    return {name: _state(name, fields.table(name)) for name in fields.names(MOST_STATES, MOST_NAME)}


def _state(name: str, fields: Fields) -> NamedState:
    fields.only(("values",), ("covariance",))
    told = fields.table("values")
    shapes = STATE_SHAPES.get(name)
    if shapes is not None:
        told.only(tuple(shapes))
    values = {}
    for key in told.names(MOST_VALUES, MOST_NAME):
        array = told.array(key, -LARGEST, LARGEST, MOST_NUMBERS)
        if shapes is not None and array.shape != shapes[key]:
            expected = "x".join(map(str, shapes[key]))
            raise told.refusal(key, f"as {expected} numbers", shown(told.value(key)))
        if key.startswith("R_"):
            try:
                array = exact_rotation(array)
            except ValueError as error:
                raise told.refusal(key, "as a rotation matrix", str(error)) from error
        values[key] = array
    if not values:
        raise fields.refusal("values", "with at least one", "none")
    if "covariance" not in fields:
        return NamedState(values)
    covariance = fields.array("covariance", -LARGEST, LARGEST, MOST_NUMBERS)
    try:
        if shapes is not None and covariance.shape != STATE_COVARIANCE_SHAPE:
            raise ValueError(f"one of shape {covariance.shape}")
        return NamedState(values, exact_covariance(covariance))
    except ValueError as error:
        raise fields.refusal("covariance", "as a covariance", str(error)) from error
