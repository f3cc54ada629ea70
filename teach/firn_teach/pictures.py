# SPDX-License-Identifier: BSD-3-Clause
"""What each stage looks like on the lesson's own scene, seen along y.

Nodes are shown in the layer of the chosen node, particles within one cell of that layer;
a ring marks the chosen particle, a square the chosen node.
"""

from firn_reports.page import Figure

from . import grid_pictures, particle_pictures
from .lesson import Lesson
from .view import View


def of_stage(lesson: Lesson, stage: int, name: str) -> list[Figure]:
    """The figures of a stage."""
    module = grid_pictures if stage <= 6 else particle_pictures
    return getattr(module, name)(View(lesson, stage))
