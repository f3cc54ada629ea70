# SPDX-License-Identifier: BSD-3-Clause
"""What `firn check --json` prints: the verdict, what it belongs to, and each field's errors."""

from collections.abc import Iterator
from pathlib import Path
from typing import TypeAlias

import numpy as np

from . import InputError, json_file
from .kinds import Json
from .page import Figure, Mark, Section, Table, number
from .scene_hash import scene_hash
from .style import BAD, SERIES, log_axis, panel, to_svg

Check: TypeAlias = Json
KIND = {"VALID": "good", "INVALID": "bad", "INCOMPLETE": "warn"}
VERSION = 2


def read(path: str | Path) -> list[Check]:
    """The checks that the output of `firn check --json` holds, several without a scene.

    Raises InputError if the file holds something else, or no verdict.
    """
    file = json_file.read(path)
    schema = file.get("schema") if isinstance(file, dict) else None
    if schema not in ("firn-check", "firn-check-set"):
        raise InputError(f"{path}: schema: got {schema}, allowed: firn-check, firn-check-set")
    if file.get("version") != VERSION:
        raise InputError(f"{path}: version: got {file.get('version')}, allowed: {VERSION}")
    checks = file["checks"] if schema == "firn-check-set" else [file]
    for check in checks:
        check["of_a_set"] = schema == "firn-check-set"
        if check.get("verdict") not in KIND:
            raise InputError(
                f"{path}: verdict: got {check.get('verdict')}, allowed: {', '.join(KIND)}"
            )
        if check["verdict"] == "VALID" and not (check.get("fields") and check.get("compared")):
            raise InputError(f"{path}: no verdict: VALID though no numbers were compared")
    if not checks:
        raise InputError(f"{path}: no verdict: the file holds no check")
    return checks


def require_same_trajectory(check: Check, facts: Json, scene_text: str, path: str | Path) -> None:
    """Raises InputError unless the check is about the solver and scene of a trajectory.

    The standard set is about a solver, whatever the scene.
    """
    pairs = [(key, check.get(other), facts.get(key)) for key, other in _SOLVER.items()]
    if not check["of_a_set"]:
        pairs.append(("scene", check.get("scene_hash"), scene_hash(scene_text)))
    for what, checked, shown in pairs:
        if checked != shown:
            raise InputError(
                f"--check: {what}: got a check of {checked} ({check.get('scene')}), "
                f"allowed: {shown}, as in {path}"
            )


def require_same_results(
    check: Check, sessions: list[Json], subjects: set[tuple[str, str]]
) -> None:
    """Raises InputError unless results hold the check's solver, measured at the same commit."""
    subject = (str(check.get("subject")), str(check.get("precision")))
    if subject not in subjects:
        raise InputError(
            f"--check: solver: got a check of {', '.join(subject)}, allowed: "
            + ", ".join(" ".join(s) for s in sorted(subjects))
        )
    commits = {session.get("git_commit") for session in sessions}
    if check.get("git_commit") not in commits:
        raise InputError(
            f"--check: git_commit: got {check.get('git_commit')}, allowed: "
            + ", ".join(sorted(str(commit) for commit in commits))
        )


_SOLVER = {"solver": "subject", "precision": "precision"}


def mark(check: Check) -> Mark:
    """The verdict, with what it lacks: VALID stands alone only where nothing is missing."""
    missing = [item["what"] for item in check.get("not_exercised", [])]
    if check["verdict"] == "VALID" and missing:
        return Mark("VALID; not exercised: " + ", ".join(missing), "warn")
    return Mark(check["verdict"], KIND[check["verdict"]])


def worst_mark(checks: list[Check]) -> Mark:
    """One verdict of several checks: what one lacked another may have exercised."""
    for verdict in ("INVALID", "INCOMPLETE"):
        for check in checks:
            if check["verdict"] == verdict:
                return mark(check)
    met = {item["key"] for c in checks for item in c.get("exercised", []) if item["count"] > 0}
    together = dict(checks[0])
    together["not_exercised"] = [
        item
        for i, c in enumerate(checks)
        for item in c.get("not_exercised", [])
        if not met & set(item.get("shown_by", []))
        and item not in [old for earlier in checks[:i] for old in earlier.get("not_exercised", [])]
    ]
    return mark(together)


def name(check: Check) -> str:
    """Which solver was checked against which."""
    return f"{check.get('subject', '?')} ({check.get('precision', '?')}) against {check.get('reference', '?')}"


def steps(check: Check) -> str:
    """The steps of the scene that were compared: "0, 258 to 260"."""
    texts = []
    for window in check.get("windows", []):
        first, last = window["start_step"], window["start_step"] + max(window["steps"], 1) - 1
        texts.append(number(first) if first == last else f"{number(first)} to {number(last)}")
    return ", ".join(texts)


def sentence(check: Check) -> str:
    """One line for the top of the page."""
    text = (
        f"{name(check)}, {check.get('scene', '?')}, {check.get('mode', '?')}, steps {steps(check)}"
    )
    divergence = check.get("first_divergence")
    if divergence:
        return f"{text}: {divergence.get('message') or 'diverges first in ' + divergence.get('through', '?')}"
    return (
        f"{text}: largest error {number(float(check.get('largest_in_bounds', 0)), 2)} of its bound"
    )


def command(check: Check) -> str:
    """What repeats the check."""
    return check.get("command") or ""


def exercised_rows(check: Check) -> Iterator[list[object]]:
    """Stage, count, and what was counted, for what occurred."""
    for item in check.get("exercised", []):
        if item["count"] > 0:
            yield [item["stage"], item["count"], f"{item['of']} {item['what']}"]


def exercised_table(check: Check, i: int) -> Table:
    """What the compared states contained."""
    return Table(
        f"check_{i}_exercised",
        f"{name(check)}: exercised in the compared steps",
        ["stage", "count", "of what"],
        list(exercised_rows(check)),
        command=command(check),
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
        result.tables += [
            fields_table(check, i),
            properties_table(check, i),
            exercised_table(check, i),
        ]
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
    return Figure(
        f"{check.get('scene', '?')}: {name(check)}",
        to_svg(plot),
        command=command(check),
        caption=sentence(check),
    )


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
