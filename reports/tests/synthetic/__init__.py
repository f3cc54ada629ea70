# SPDX-License-Identifier: BSD-3-Clause
"""Small files of known content in Firn's formats: for tests, and for trying the page."""

from .cases import synthetic_cases
from .check import check
from .results import write_results
from .trajectory import SCENE, write_trajectory

__all__ = ["SCENE", "check", "synthetic_cases", "write_results", "write_trajectory"]
