# SPDX-License-Identifier: BSD-3-Clause
"""What `firn check --json` prints: the verdict, the fields that each stage wrote, properties."""

from pathlib import Path
from typing import TypeAlias

import numpy as np

from . import InputError, json_file
from .kinds import Json
from .page import Figure, Mark, Section, Table, number
from .style import BAD, SERIES, log_axis, panel, to_svg

Check: TypeAlias = Json
KIND = {"VALID": "good", "INVALID": "bad"}


def read(path: str | Path) -> Check:
    """The output of `firn check --json`.

    Raises InputError if the file holds something else.
    """
    check = json_file.read(path)
    if not isinstance(check, dict) or check.get("verdict") not in KIND or "fields" not in check:
        raise InputError(
            f"{path}: no `verdict` and `fields`: allowed: what `firn check --json` prints"
        )
    return check


def mark(check: Check) -> Mark:
    """The verdict as a coloured word."""
    return Mark(check["verdict"], KIND[check["verdict"]])


def name(check: Check) -> str:
    """Which solver was checked against which."""
    return f"{check.get('subject', '?')} ({check.get('precision', '?')}) against {check.get('reference', '?')}"


def sentence(check: Check) -> str:
    """One line for the top of the page."""
    text = f"{name(check)}, {number(int(check.get('steps', 0)))} steps of {check.get('scene', '?')}, {check.get('mode', '?')}"
    divergence = check.get("first_divergence")
    if divergence:
        return f"{text}: {divergence.get('message') or 'diverges first in ' + divergence.get('through', '?')}"
    return (
        f"{text}: largest error {number(float(check.get('largest_in_bounds', 0)), 2)} of its bound"
    )


def command(check: Check) -> str:
    """What repeats the check."""
    return (
        f"firn check {check.get('scene', 'SCENE')} --solver {check.get('subject', '?')} "
        f"--against {check.get('reference', 'reference')} --precision {check.get('precision', 'double')} "
        f"--mode {check.get('mode', 'lockstep')} --steps {check.get('steps', 1)} --json"
    )


def section(checks: list[Check]) -> Section:
    """The section of a page about these checks."""
    result = Section(
        "check",
        "Stage by stage against the reference",
        "Every field that a stage writes, in units of its bound, which follows from roundoff. At 1 the error reaches the bound.",
    )
    for i, check in enumerate(checks, 1):
        result.figures.append(figure(check))
        result.tables += [fields_table(check, i), properties_table(check, i)]
    result.tables = [table for table in result.tables if table.rows]
    return result


def stages(row: Json) -> str:
    """The stage that wrote the fields of a row, or the first and the last of several."""
    return (
        row["through"]
        if row.get("from") == row.get("through")
        else f"{row.get('from')} … {row.get('through')}"
    )


def figure(check: Check) -> Figure:
    """Largest error of each field, in bounds, worst repetition of each kept."""
    worst: dict[str, float] = {}
    for row in check["fields"]:
        key = f"{row.get('written_by') or 'kept'}: {row['field'].replace('node_', '').replace('particle_', '')}"
        worst[key] = max(worst.get(key, 0.0), float(row["largest_in_bounds"]))
    labels, values = list(worst), np.array(list(worst.values()))
    plot, axes = panel(4.6, 0.9 + 0.21 * max(len(labels), 4))
    finite = np.where(np.isfinite(values), np.maximum(values, 1e-4), 1e6)
    for y, value in enumerate(finite):
        axes.plot(
            [1e-4, value],
            [y, y],
            color=SERIES[0] if value <= 1 else BAD,
            linewidth=4,
            solid_capstyle="butt",
        )
    axes.axvline(1, color=BAD, linewidth=1, linestyle="--")
    axes.set_yticks(range(len(labels)), labels)
    axes.set_ylim(len(labels) - 0.5, -0.5)
    axes.set_xlim(1e-4, max(3, 2 * finite.max(initial=1)))
    log_axis(axes, "x")
    axes.set_xlabel("largest error, in units of its bound", loc="right")
    axes.grid(False, axis="y")
    return Figure(name(check), to_svg(plot), command=command(check), caption=sentence(check))


def fields_table(check: Check, i: int) -> Table:
    """One row per stage and field."""
    columns = [
        "stage",
        "field",
        "units",
        "values compared",
        "largest error",
        "rms error",
        "largest relative",
        "largest in bounds",
        "rms in bounds",
        "worst at",
        "solver",
        "reference",
        "verdict",
    ]
    rows = []
    for row in check["fields"]:
        worst = row.get("worst", {})
        place = (
            f"node {tuple(worst['node'])}"
            if "node" in worst
            else f"particle {worst['particle']}"
            if "particle" in worst
            else "–"
        )
        rows.append(
            [
                stages(row),
                row["field"],
                row.get("units"),
                row.get("compared"),
                row.get("largest_absolute"),
                row.get("rms_absolute"),
                row.get("largest_relative"),
                row["largest_in_bounds"],
                row.get("rms_in_bounds"),
                place,
                worst.get("subject"),
                worst.get("reference"),
                Mark(row["verdict"], KIND.get(row["verdict"], "warn")),
            ]
        )
    return Table(
        f"check_{i}_fields", f"{name(check)}: fields", columns, rows, command=command(check)
    )


def properties_table(check: Check, i: int) -> Table:
    """One row per property: momentum, mass and others that a check looks at."""
    rows = [
        [
            row["name"],
            row["compared"],
            Mark(row["verdict"], KIND.get(row["verdict"], "warn")),
            row["detail"],
        ]
        for row in check.get("properties", [])
    ]
    return Table(
        f"check_{i}_properties",
        f"{name(check)}: properties",
        ["property", "compared", "verdict", "detail"],
        rows,
        command=command(check),
    )
