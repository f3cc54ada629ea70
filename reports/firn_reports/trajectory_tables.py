# SPDX-License-Identifier: BSD-3-Clause
"""The tables of a trajectory's page."""

import numpy as np

from .page import Table, number
from .trajectory import Trajectory

AXES = "xyz"


def fact_table(trajectory: Trajectory, run: str) -> Table:
    """Solver, machine and size of the run."""
    rows = [
        ["particles", number(trajectory.particles)],
        ["steps", number(trajectory.steps)],
        ["frames", number(len(trajectory.times))],
        ["end", f"{number(float(trajectory.times[-1]))} s"],
    ]
    rows += [[name.replace("_", " "), value] for name, value in sorted(trajectory.facts.items())]
    wall = trajectory.facts.get("wall_time")
    if wall and float(wall) > 0:
        rate = trajectory.particles * trajectory.steps / float(wall)
        rows.insert(2, ["particle-steps per second", number(rate, 3)])
    return Table("facts", "Run", ["fact", "value"], rows, command=run, open=True)


def diagnostics_table(trajectory: Trajectory, run: str, most: int = 400) -> Table:
    """Every step, or evenly chosen rows of a long run."""
    d = trajectory.diagnostics
    rows = np.unique(np.linspace(0, len(d["time"]) - 1, min(len(d["time"]), most)).astype(int))
    columns, values = [], []
    for name, array in d.items():
        parts = array.T if array.ndim == 2 else [array]
        for suffix, part in zip(AXES if array.ndim == 2 else [""], parts, strict=True):
            columns.append(f"{name}{'_' if suffix else ''}{suffix} [{trajectory.units[name]}]")
            values.append(part[rows])
    return Table(
        "diagnostics",
        "Diagnostics by step",
        columns,
        [[float(v[i]) for v in values] for i in range(len(rows))],
        caption=""
        if len(rows) == len(d["time"])
        else f"{len(rows)} of {len(d['time'])} steps, evenly chosen; the file has all.",
        command=run,
    )
