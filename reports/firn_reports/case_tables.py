# SPDX-License-Identifier: BSD-3-Clause
"""Every session, case and repetition of a results file as tables."""

import numpy as np

from .page import Code, Table
from .results import Case, Results
from .results_tables import mark


def loop_spread(case: Case) -> str:
    """(slowest − fastest) / median of the fixed loop around one case."""
    loop = case.calibration
    return f"{100 * (loop.max() - loop.min()) / np.median(loop):.2g} %" if len(loop) else ""


def sessions(results: Results) -> Table:
    """Facts of every session; what is as in the first one is not repeated."""

    def cell(i: int, key: str) -> str | None:
        value = results.sessions[i].get(key)
        value = None if value is None else str(value)
        return (
            "″" if i and value is not None and value == str(results.sessions[0].get(key)) else value
        )

    keys = list(dict.fromkeys(key for s in results.sessions for key in s))
    return Table(
        "machine",
        "Machine and build",
        ["fact"] + [f"session {i}" for i in range(len(results.sessions))],
        [
            [key.replace("_", " ")] + [cell(i, key) for i in range(len(results.sessions))]
            for key in keys
        ],
        "A session is one run of firn bench or firn verify that added to the file; ″: as in session 0.",
        "firn info",
        open=True,
    )


def all_cases(results: Results) -> Table:
    """Every case with its status and times."""
    return Table(
        "cases",
        "Every case",
        [
            "suite",
            "case",
            "status",
            "remark",
            "session",
            "took [s]",
            "processor time [s]",
            "fixed loop varied by",
            "measure again",
        ],
        [
            [
                c.suite,
                c.name,
                mark(c.status),
                c.message,
                c.session,
                c.wall_seconds,
                c.processor_seconds,
                loop_spread(c),
                Code(c.command),
            ]
            for c in results.cases
        ],
        command="firn bench",
    )


def noisy(results: Results) -> list[Table]:
    """The cases that are too noisy to quote."""
    rows = [
        [c.suite, c.name, c.message, loop_spread(c), c.wall_seconds, Code(c.command)]
        for c in results.cases
        if c.status == "noisy"
    ]
    return (
        [
            Table(
                "noisy",
                "Too noisy to quote",
                ["suite", "case", "why", "fixed loop varied by", "took [s]", "measure again"],
                rows,
                "Their repetitions are in the file and under “Every repetition”; their medians are not quoted anywhere.",
                "firn bench",
            )
        ]
        if rows
        else []
    )


def repetitions(results: Results) -> Table:
    """Every measured number of the file."""
    rows = [
        [c.suite, c.name, key, q.units, i, float(v)]
        for c in results.cases
        for key, q in c.quantities.items()
        for i, v in enumerate(q.values)
    ]
    return Table(
        "repetitions",
        "Every repetition",
        ["suite", "case", "quantity", "units", "repetition", "value"],
        rows,
        command="firn bench",
    )
