# SPDX-License-Identifier: BSD-3-Clause
"""The few numbers of a results file that its summary quotes."""

import re

import numpy as np

from . import drawing
from .page import number
from .results import Case, Results


def worst_scaling(results: Results) -> tuple[float, int, str, Case] | None:
    """(speed-up, threads, who, case) where more threads bring least, from interleaved runs."""
    rows = [
        (
            c.value("efficiency") * c["threads"],
            c["threads"],
            f"{drawing.who(c)}, {c['deformation']}, {number(c['particles'])} particles",
            c,
        )
        for c in results.suite("scaling")
        if c.value("efficiency") is not None
    ]
    return min(rows, key=lambda row: row[0] / row[1], default=None)


def size_growth(results: Results) -> tuple[float, str, Case] | None:
    """(cost per particle of many over that of few, who, case) where it grows most.

    From interleaved runs.
    """
    rows = [
        (c.median("growth"), f"{drawing.who(c)}, {c['deformation']}, {number(c['particles'])}", c)
        for c in results.suite("scaling")
        if c.value("growth") is not None
    ]
    return max(rows, key=lambda row: row[0], default=None)


def costliest_skip(results: Results) -> tuple[float, str, str] | None:
    """(cost, skip, situation) of the skip that costs most, None if all cost less than 2 %."""
    # A cost that the quartiles of the repetitions do not tell from none is none.
    rows = [
        (-c.median("saved"), c["skip"], c["situation"])
        for c in results.suite("skips")
        if c.quotable and c.quantities["saved"].quartiles[1] <= 0
    ]
    worst = max(rows, default=None)
    return worst if worst and worst[0] > 0.02 else None


def worst_float(results: Results) -> tuple[float, str] | None:
    """(error, test and solver) of the largest loss to single precision."""
    rows = [
        (c.median("error"), f"{c['test']}, {c['solver']}")
        for c in results.suite("float")
        if c.quotable and c["precision"] == "float"
    ]
    return max(rows, default=None)


def busiest(results: Results) -> tuple[float, int] | None:
    """(load average, processors) of the timing session that began under the highest load.

    None unless others were using the machine.
    """
    loads = [
        (float(match[0]), int(s.get("processors", 1)))
        for s in results.sessions
        if "cases_asked_for" in s
        if (match := re.match(r"[0-9.]+", str(s.get("load_average", ""))))
    ]
    worst = max(loads, default=None)
    return worst if worst and worst[0] > 0.5 * worst[1] else None


def noise(results: Results) -> float | None:
    """Distance of the quartiles of the fixed loop over all cases, relative to its median."""
    loops = [c.calibration for c in results.cases if len(c.calibration)]
    if not loops:
        return None
    everything = np.concatenate(loops)
    low, high = np.percentile(everything, [25, 75])
    return float((high - low) / np.median(everything))
