"""The tables of a results page, and the few numbers that its summary quotes."""

import re
from collections.abc import Sequence
from typing import Any

import numpy as np

from . import results_figures as figures
from .baseline import Change
from .page import Code, Mark, Table, number
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
        for c, rate, intensity, share in figures.roofline_points(results)
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


def worst_scaling(results: Results) -> tuple[float, int, str, Case] | None:
    """(speed-up, threads, who, case) where more threads bring least, from interleaved runs."""
    rows = [
        (
            c.value("efficiency") * c["threads"],
            c["threads"],
            f"{figures.who(c)}, {c['deformation']}, {number(c['particles'])} particles",
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
        (c.median("growth"), f"{figures.who(c)}, {c['deformation']}, {number(c['particles'])}", c)
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


def loop_spread(case: Case) -> str:
    """(slowest − fastest) / median of the fixed loop around one case."""
    loop = case.calibration
    return f"{100 * (loop.max() - loop.min()) / np.median(loop):.2g} %" if len(loop) else ""


def noise(results: Results) -> float | None:
    """Distance of the quartiles of the fixed loop over all cases, relative to its median."""
    loops = [c.calibration for c in results.cases if len(c.calibration)]
    if not loops:
        return None
    everything = np.concatenate(loops)
    low, high = np.percentile(everything, [25, 75])
    return float((high - low) / np.median(everything))


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
