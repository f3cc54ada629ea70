# SPDX-License-Identifier: BSD-3-Clause
"""The rows of the tables of a stage."""

import numpy as np
from numpy.typing import ArrayLike

from firn_reports.kinds import Json

from . import STAGES, lesson as lesson_file
from .lesson import Lesson


def components(value: ArrayLike) -> list[tuple[str, float]]:
    """Return a scalar, vector or matrix as (name, number): "", "x", or row and column."""
    numbers = np.asarray(value)
    if numbers.ndim == 1:
        return list(zip("xyz", numbers, strict=True))
    if numbers.ndim == 2:
        return [(f"{r + 1}{c + 1}", numbers[r, c]) for r in range(3) for c in range(3)]
    return [("", float(numbers))]


def number_rows(lesson: Lesson, stage: int, of_node: bool) -> list[Json]:
    """The fields that a stage writes, before and after, for the chosen node or particle."""
    record, rows = lesson.record_of(stage), []
    index = lesson.i if of_node else lesson.p
    for name in record.written.get(STAGES[stage - 1], []):
        if (name in lesson_file.NODE_FIELDS) != of_node or not record.has(stage, name):
            continue
        after = components(getattr(record.at(stage), name)[index])
        before: list[tuple[str, float | None]] = [("", None)] * len(after)
        if record.has(stage - 1, name):
            before[:] = components(getattr(record.at(stage - 1), name)[index])
        label = (LABELS | {"V_p0": "V_p0 (0: not known yet)"}).get(name, name)
        rows.append(
            {
                "field": name,
                "label": label,
                "units": lesson_file.UNITS[name],
                "components": [
                    (c, "–" if b is None else repr(float(b)), repr(float(a)))
                    for (c, a), (_, b) in zip(after, before, strict=True)
                ],
            }
        )
    return rows


# What each stage reads besides what it changes: of the particle, of the node.
READS = {
    1: (["m_p", "x_p", "v_p"], []),
    2: (["m_p", "x_p"], ["m_i"]),
    3: (["V_p0", "F_E", "F_P"], ["m_i"]),
    4: ([], ["m_i", "v_i", "f_i"]),
    5: ([], ["m_i"]),
    6: (["F_E", "F_P"], ["v_i_star"]),
    7: (["x_p"], ["v_i_new"]),
    8: ([], ["v_i", "v_i_new"]),
    9: (["x_p"], []),
    10: (["v_p"], []),
}
LABELS = {"v_i_star": "v_i*", "v_i_new": "v_i at n+1"}


def read_rows(lesson: Lesson, stage: int) -> list[tuple[str, str, str, list[tuple[str, str]]]]:
    """Inputs as they stand before the stage, and the pair's own weight.

    Rows (owner, label, units, components).
    """
    record, rows = lesson.record_of(stage), []
    own_nodes = stage != 2  # the chosen node belongs to the step shown on the other pages
    for of_node, names in enumerate(READS[stage]):
        for name in names:
            if of_node and not own_nodes:
                continue
            value = getattr(record.at(stage - 1), name)[lesson.i if of_node else lesson.p]
            rows.append(
                (
                    lesson.node_name if of_node else lesson.particle_name,
                    LABELS.get(name, name),
                    lesson_file.UNITS[name],
                    [(c, repr(float(x))) for c, x in components(value)],
                )
            )
    pair = next((n for n in lesson.data["stencil"] if n["node"] == lesson.i), None)
    if pair and stage in (1, 3, 7, 8):
        rows.append(("both", "w_ip", "1", [("", repr(pair["w_ip"]))]))
    if pair and stage in (3, 7):
        rows.append(
            ("both", "∇w_ip", "1/m", list(zip("xyz", map(repr, pair["grad_w_ip"]), strict=True)))
        )
    return rows


def check_rows(lesson: Lesson, stage: int) -> list[Json]:
    """What the check found for the fields that this stage wrote."""
    rows = []
    for check in lesson.checks:
        kind = " semi-implicit" if check["semi_implicit"] else ""
        for row in check["fields"]:
            if (
                row["written_by"] == STAGES[stage - 1]
                and row["from"] == row["through"] == STAGES[stage - 1]
                and row["compared"]
            ):
                rows.append(
                    {
                        **row,
                        "precision": check["precision"] + kind,
                        "kind": "good" if row["verdict"] == "VALID" else "bad",
                    }
                )
    return rows
