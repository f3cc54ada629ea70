# SPDX-License-Identifier: BSD-3-Clause
"""What `firn check --dump` writes: the error of every particle and node, in units of its bound."""

from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np

from . import InputError
from .kinds import Array, Mask
from .page import Figure, Section, number
from .style import BAD, MUTED, SERIES, legend, log_axis, panel, to_svg

OTHER = ("id", "node", "worst")  # arrays that are no row of the check's table


@dataclass
class ErrorMap:
    """The frame with the largest error, and for the histograms all of them."""

    path: Path
    time: float  # [s]
    points: Array  # of that frame (n, 3) [m]
    worst: Array  # of that frame, in bounds
    is_node: Mask
    rows: dict[str, Array]  # by stage and field, over all frames, where the row has a number


def read(path: str | Path) -> ErrorMap:
    """Raises InputError if the file is none of `firn check --dump`."""
    try:
        with h5py.File(path) as file:
            vtk = file["VTKHDF"]
            data = {name: vtk["PointData"][name][:] for name in vtk["PointData"]}
            counts = vtk["NumberOfPoints"][:]
            times = vtk["Steps/Values"][:]
            points = vtk["Points"][:]
    except (OSError, KeyError) as error:
        raise InputError(f"{path}: {error}: allowed: what `firn check --dump` writes") from None
    if "worst" not in data or "id" not in data:
        raise InputError(f"{path}: no array `worst`: allowed: what `firn check --dump` writes")
    ends = np.cumsum(counts)
    worst = int(
        np.argmax([data["worst"][e - n : e].max() for n, e in zip(counts, ends, strict=True)])
    )
    part = slice(ends[worst] - counts[worst], ends[worst])
    rows = {name: values[values > 0] for name, values in data.items() if name not in OTHER}
    return ErrorMap(
        Path(path),
        float(times[worst]),
        points[part],
        data["worst"][part],
        data["id"][part] < 0,
        rows,
    )


def section(errors: ErrorMap, command: str) -> Section:
    """Histograms and a map in space."""
    return Section(
        "errors",
        "Where the errors are",
        "The error of every particle and node of the compared steps, in units of its bound. Beyond 1 it is wrong.",
        figures=[histogram(errors, command), space(errors, command)],
    )


def label(row: str) -> str:
    """The name of a row as people read it: the stage's underscores are blanks, the field's stay."""
    stage, _, what = row.rpartition(" ")
    return f"{stage.replace('_', ' ')}: {what}"


def histogram(errors: ErrorMap, command: str) -> Figure:
    """How many numbers have an error of which size, for the rows with the largest errors."""
    largest = {name: values.max() for name, values in errors.rows.items() if values.size}
    names = sorted(largest, key=lambda name: -largest[name])[:4]
    top = max([3.0, *(float(min(largest[name], 1e30)) for name in names)])
    bins = np.geomspace(1e-4, 2 * top, 40)
    plot, axes = panel(4.6, 3.1)
    for name in names:
        counts, _ = np.histogram(np.clip(errors.rows[name], 1e-4, top), bins)
        axes.stairs(counts, bins, label=label(name))
    axes.axvline(1, color=BAD, linewidth=1, linestyle="--")
    log_axis(axes, "x")
    axes.set_yscale("symlog", linthresh=1)
    axes.set_xlabel("error, in units of its bound")
    axes.set_ylabel("points")
    if names:
        legend(axes)
    return Figure(
        "How large the errors are",
        to_svg(plot),
        command=command,
        caption="The four rows of the check with the largest errors; points without an error are left out.",
    )


def space(errors: ErrorMap, command: str) -> Figure:
    """Particles and nodes seen along y, wrong ones on top."""
    plot, axes = panel(4.6, 3.6)
    bad = ~(errors.worst <= 1)
    x, z = errors.points[:, 0], errors.points[:, 2]
    axes.scatter(x[~bad], z[~bad], s=3, color=MUTED, alpha=0.35, linewidths=0, rasterized=True)
    for what, chosen, marker, colour in (
        ("particles", bad & ~errors.is_node, "o", BAD),
        ("nodes", bad & errors.is_node, "s", SERIES[1]),
    ):
        if chosen.any():
            axes.scatter(
                x[chosen],
                z[chosen],
                s=9,
                marker=marker,
                color=colour,
                linewidths=0,
                rasterized=True,
                label=f"{number(int(chosen.sum()))} {what} wrong",
            )
    axes.set_aspect("equal")
    axes.set_xlabel("x [m]")
    axes.set_ylabel("z [m]")
    if bad.any():
        legend(axes)
    return Figure(
        f"Where they are, at t = {number(errors.time, 4)} s",
        to_svg(plot),
        command=command,
        caption="Every particle and node of the step with the largest error, seen along y; grey: within its bounds.",
    )
