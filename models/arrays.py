"""The array types that signatures use; shapes, units and frames are told by each docstring."""

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

Floats: TypeAlias = NDArray[np.float64]
Image: TypeAlias = NDArray[np.uint16]
Radiance: TypeAlias = NDArray[np.float32]
Labels: TypeAlias = NDArray[np.uint8]
Mask: TypeAlias = NDArray[np.bool_]
Indices: TypeAlias = NDArray[np.int64]
AnyArray: TypeAlias = NDArray[Any]
