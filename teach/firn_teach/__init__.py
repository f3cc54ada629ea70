# SPDX-License-Identifier: BSD-3-Clause
"""Makes the pages of a lesson from lesson.json, which `firn teach` writes.

lesson.py      the recorded step as arrays
by_hand.py     every stage once more in a few lines of NumPy, run on the lesson
pictures.py    what each stage looks like: view.py, grid_pictures.py, particle_pictures.py
source.py      the reference's own source of a stage
measured.py    commands of the exercises, run for their answers
mathml.py      formulas
chapters/      the text, which chapter.py reads
rows.py        the tables of a stage
extras.py      the pages beside the stages
pages.py       puts it together
"""

STAGES = [
    "rasterize",
    "volumes",
    "grid_forces",
    "grid_velocities",
    "grid_collisions",
    "integration",
    "deformation",
    "particle_velocities",
    "particle_collisions",
    "positions",
]
