"""Names for the types of arrays."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["Floats"]

#: An array of double-precision numbers.
Floats = NDArray[np.float64]
