# SPDX-License-Identifier: BSD-3-Clause
"""The tables of a results page, and the few numbers that its summary quotes."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from . import roofline
from .baseline import Change
from .page import Code, Mark, Table
from .results import Case, Results

KIND = {
    "measured": "good",
    "noisy": "warn",
    "invalid": "bad",
    "failed": "bad",
    "VALID": "good",
    "INVALID": "bad",
    "worse": "bad",
    "better": "good",
    "same": "",
    "drowned": "warn",
}


def mark(text: str) -> Mark | str:
    """The status or verdict as a coloured word."""
    return Mark(text, KIND[text]) if KIND.get(text) else text


def of_suite(results: Results, suite: str, name: str, title: str) -> list[Table]:
    """The table of a suite, empty if nothing was measured."""
    return of_cases(results.suite(suite), name, title, f"firn bench {suite}")


def of_cases(cases: Sequence[Case], name: str, title: str, command: str) -> list[Table]:
    """Every case: its parameters, the median and spread of each quantity, its command."""
    cases = sorted(cases, key=lambda c: c.name)
    if not cases:
        return []
    parameters = list(dict.fromkeys(key for c in cases for key in c.parameters))
    quantities = list(dict.fromkeys(key for c in cases for key in c.quantities))
    units = {key: q.units for c in cases for key, q in c.quantities.items()}
    columns = (
        parameters
        + [text for key in quantities for text in (f"{key} [{units[key]}]", "spread")]
        + ["status", "measure again"]
    )
    rows = []
    for c in cases:
        row = [c.parameters.get(key) for key in parameters]
        for key in quantities:
            quantity = c.quantities.get(key)
            # What is too noisy to quote gives no number.
            row += (
                [
                    quantity.median,
                    f"{100 * quantity.spread:.2g} %" if len(quantity.values) > 2 else "",
                ]
                if quantity and c.quotable
                else [None, ""]
            )
        rows.append([*row, mark(c.status), Code(c.command)])
    return [
        Table(
            name,
            title,
            columns,
            rows,
            "Medians; spread is from the first to the third quartile, relative to the median.",
            command,
        )
    ]


def roofline_points(results: Results) -> list[Table]:
    """Whole steps against the ceilings."""
    rows = [
        [
            c["solver"],
            c["precision"],
            c["threads"],
            c["deformation"],
            c["particles"],
            rate / 1e9,
            intensity,
            100 * share,
            Code(c.command),
        ]
        for c, rate, intensity, share in roofline.roofline_points(results)
    ]
    return (
        [
            Table(
                "roofline_points",
                "Whole steps against the ceilings",
                [
                    "solver",
                    "precision",
                    "threads",
                    "deformation",
                    "particles",
                    "Gflop/s, plain count",
                    "flop per byte",
                    "% of FMA peak",
                    "measure again",
                ],
                rows,
                command="firn bench roofline steps",
            )
        ]
        if rows
        else []
    )


def changes(changes: list[Change], broken: list[Case]) -> list[Table]:
    """What moved, open; everything that was compared, folded."""
    order = {"worse": 0, "better": 1, "drowned": 2, "same": 3}
    columns = [
        "suite",
        "case",
        "quantity",
        "old",
        "new",
        "units",
        "% worse",
        "± %",
        "verdict",
        "measure again",
    ]
    rows: list[list[Any]] = [
        [
            c.case.suite,
            c.case.name,
            c.quantity,
            c.old,
            c.new,
            c.units,
            100 * (c.ratio - 1),
            100 * c.uncertainty,
            mark(c.kind),
            Code(c.case.command),
        ]
        for c in sorted(changes, key=lambda c: (order[c.kind], -abs(np.log(c.ratio))))
    ]
    rows = [
        [c.suite, c.name, "", None, None, "", None, None, mark(c.status), Code(c.command)]
        for c in broken
    ] + rows
    moved = [row for row in rows if str(row[8]) not in ("same", "drowned")]
    made = [Table("baseline_moved", "What moved", columns, moved, open=True)] if moved else []
    return [
        *made,
        Table(
            "baseline",
            "Every comparison",
            columns,
            rows,
            "drowned: one of the two is too noisy to quote. ± : three standard errors of both medians, for times with the change of the fixed loop around the case.",
        ),
    ]


def verification(results: Results) -> list[Table]:
    """One table per solver verified."""
    made = []
    for i, (subject, verdict) in enumerate(results.verify.items(), 1):
        rows = sorted(verdict["rows"], key=lambda r: (r["verdict"] == "VALID", -r["error"]))
        made.append(
            Table(
                f"verify_{i}",
                f"{subject}: {verdict['verdict']}",
                ["topic", "check", "largest error in bounds", "verdict", "repeat"],
                [
                    [r["topic"], r["check"], r["error"], mark(r["verdict"]), Code(r["command"])]
                    for r in rows
                ],
                "Failures first, then by how near the bound was.",
                verdict["command"],
                open=verdict["verdict"] != "VALID",
            )
        )
    return made


def mutants(results: Results) -> list[Table]:
    """Which check caught each mutant."""
    if not results.mutants:
        return []
    rows = sorted(results.mutants["rows"], key=lambda r: (bool(r["caught"]), r["name"]))
    return [
        Table(
            "mutants",
            "Deliberately wrong solvers",
            ["mutant", "what was changed", "lives in", "check names", "caught by", "verdict"],
            [
                [
                    r["name"],
                    r["patch"],
                    r["stage"],
                    r["named_stage"],
                    r["caught_by"],
                    Mark("caught", "good") if r["caught"] else Mark("survived", "bad"),
                ]
                for r in rows
            ],
            command=results.mutants.get("command", ""),
        )
    ]
