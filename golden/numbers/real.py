"""The type of real numbers in all floating-point models."""

import numpy as np
from numpy.typing import NDArray

Real = NDArray[np.float64]
