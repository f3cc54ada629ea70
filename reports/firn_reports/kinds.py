# SPDX-License-Identifier: BSD-3-Clause
"""Names of types that several modules use."""

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.float64]
Mask: TypeAlias = NDArray[np.bool_]
Indices: TypeAlias = NDArray[np.int_]
# What TOML or JSON holds: keys and values of any kind, checked by the program that wrote it.
Json: TypeAlias = dict[str, Any]
