# SPDX-License-Identifier: BSD-3-Clause
"""Times to reach an error, and observed orders: tables of the suite `accuracy`."""

import math
from collections.abc import Sequence

import numpy as np

from .accuracy import best_covered, integration, is_explicit, line_name, method, problems, quoted
from .page import Code, Table
from .results import Case, Results

# Errors that a user might ask for.
TARGETS = (0.1, 0.03, 0.01, 0.003, 0.001)


def reaching(cases: Sequence[Case], target: float) -> Case | None:
    """The fastest case whose error is at most `target`, or None."""
    return min(
        (c for c in cases if c.value("time") and c.median("error") <= target),
        key=lambda c: c.median("time"),
        default=None,
    )


def time_to_error(results: Results) -> list[Table]:
    """Table of the times to reach a given error, for every method and problem."""
    rows = []
    cases = quoted(results)
    for problem in problems(cases):
        mine = [c for c in cases if c["problem"] == problem]
        for target in TARGETS:
            found = [
                (name, c)
                for name in sorted({method(c) for c in mine})
                if (c := reaching([m for m in mine if method(m) == name], target)) is not None
            ]
            fastest = min((c.median("time") for _, c in found), default=math.nan)
            for name, c in sorted(found, key=lambda f: f[1].median("time")):
                rows.append(
                    [
                        problem,
                        target,
                        name,
                        c.median("time"),
                        c.median("time") / fastest,
                        c.median("error"),
                        c["cells"],
                        c["cfl"],
                        str(c["alpha_policy"]),
                        integration(c),
                        Code(c.command),
                    ]
                )
    return (
        [
            Table(
                "time_to_error",
                "Time to reach a given error",
                [
                    "problem",
                    "error asked for",
                    "method",
                    "wall time [s]",
                    "times the fastest",
                    "error reached",
                    "cells",
                    "CFL",
                    "α",
                    "integration",
                    "measure again",
                ],
                rows,
                "The fastest run over h, Δt, α and β whose error is small enough. A method without a row did not reach that error in any run.",
                "firn bench accuracy",
                open=True,
            )
        ]
        if rows
        else []
    )


def order_rows(results: Results) -> list[tuple[Case, Case, float]]:
    """Order between neighbouring resolutions at CFL 0.4: (case, finer case, order)."""
    rows = []
    cases = [c for c in quoted(results) if is_explicit(c) and c["cfl"] == 0.4]
    for coarse in cases:
        fine = next(
            (
                f
                for f in cases
                if f["h"] == coarse["h"] / 2
                and line_name(f) == line_name(coarse)
                and f["problem"] == coarse["problem"]
            ),
            None,
        )
        if fine:
            rows.append(
                (coarse, fine, float(np.log2(coarse.median("error") / fine.median("error"))))
            )
    return sorted(rows, key=lambda r: (str(r[0]["problem"]), line_name(r[0]), -r[0]["h"]))


def order_table(results: Results) -> list[Table]:
    """Observed orders between neighbouring resolutions."""
    rows = [
        [
            c["problem"],
            c["solver"],
            c["precision"],
            str(c["alpha_policy"]),
            c["cells"],
            f["cells"],
            c.value("error"),
            f.value("error"),
            order,
            Code(f.command),
        ]
        for c, f, order in order_rows(results)
    ]
    return (
        [
            Table(
                "orders",
                "Observed orders",
                [
                    "problem",
                    "solver",
                    "precision",
                    "α",
                    "cells",
                    "finer",
                    "error",
                    "finer error",
                    "order",
                    "measure again",
                ],
                rows,
                "Order between two resolutions, Δt ∝ h.",
                "firn bench accuracy",
            )
        ]
        if rows
        else []
    )


def best_order(results: Results) -> tuple[float, str] | None:
    """The order of the standing wave without damping, and a text that says what it was measured on.

    From the coarsest to the finest run of the solver with most resolutions; None without two.
    """
    cases = [
        c
        for c in quoted(results)
        if c["problem"] == "standing wave"
        and is_explicit(c)
        and c["cfl"] == 0.4
        and str(c["alpha_policy"]) == "1"
        and c["precision"] == "double"
    ]
    line = sorted(best_covered(cases, "h"), key=lambda c: -c["h"])
    if len(line) < 2:
        return None
    coarse, fine = line[0], line[-1]
    order = np.log(coarse.median("error") / fine.median("error")) / np.log(coarse["h"] / fine["h"])
    return float(
        order
    ), f"standing wave, α = 1, {coarse['cells']} to {fine['cells']} cells, {coarse['solver']}"
