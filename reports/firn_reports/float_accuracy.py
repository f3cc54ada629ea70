# SPDX-License-Identifier: BSD-3-Clause
"""Single precision beside double, and what each solver did under stress."""

from collections.abc import Sequence

from .drawing import bars, styles, who
from .page import Code, Figure, Mark, Table
from .results import Case, Results
from .style import legend, log_axis, panel, plain, to_svg


def drift(cases: Sequence[Case]) -> Figure:
    """Error against steps of the cases that say it for several numbers of steps."""
    figure, axes = panel()
    for name, style in styles(who(c) for c in cases).items():
        case = next(c for c in cases if who(c) == name)
        points = sorted(
            (int(q.name.split()[2]), q.median)
            for q in case.quantities.values()
            if q.name.startswith("error after")
        )
        axes.plot([p[0] for p in points], [max(p[1], 1e-17) for p in points], label=name, **style)
    log_axis(axes, "x")
    log_axis(axes, "y")
    axes.set_xlabel("steps")
    axes.set_ylabel("RMS difference of velocity from the reference")
    legend(axes)
    return Figure(
        "Drift of a ringing elastic block",
        to_svg(figure),
        command="firn bench 'float/drift*'",
        caption="Both start from the same state; compared with the reference in double.",
    )


# A logarithmic axis has no zero.
ZERO = 1e-17


def float_accuracy(results: Results) -> list[Figure]:
    """One figure per test of single precision."""
    made = []
    cases = [c for c in results.suite("float") if c.quotable]
    drifting = sorted([c for c in cases if c["test"] == "drift"], key=lambda c: c.name)
    if drifting:
        made.append(drift(drifting))
    for test in dict.fromkeys(c["test"] for c in cases if c["test"] != "drift"):
        mine = sorted([c for c in cases if c["test"] == test], key=lambda c: c.name)
        errors = [max(c.median("error"), ZERO) for c in mine]
        rows = [(who(c), error, error, error) for c, error in zip(mine, errors, strict=True)]
        meaning = next(iter(mine[0].quantities.values())).meaning
        made.append(
            Figure(
                str(mine[0]["what"]),
                bars(
                    rows,
                    meaning,
                    log=True,
                    text=lambda value: "0" if value <= ZERO else plain(float(f"{value:.3g}")),
                ),
                command=f"firn bench 'float/{test}*'",
                caption="1 would mean that nothing moved."
                if test in ("creep", "small strain")
                else "",
            )
        )
    return made


def stress_table(results: Results) -> list[Table]:
    """One row per situation, one column per solver: what it did."""
    cases = results.suite("stress")
    if not cases:
        return []
    solvers = sorted({who(c) for c in cases}, reverse=True)
    rows = []
    for situation in dict.fromkeys(c["situation"] for c in cases):
        mine = {who(c): c for c in cases if c["situation"] == situation}
        any_case = next(iter(mine.values()))
        cells = []
        for solver in solvers:
            case = mine.get(solver)
            text = str(case["outcome"] or case.message) if case else "–"
            cells.append(Mark(text, "bad") if case and case.status != "measured" else text)
        rows.append(
            [situation, any_case["expected"], *cells, Code(f"firn bench 'stress/{situation}*'")]
        )
    return [
        Table(
            "stress",
            "Under stress: what each solver did",
            ["situation", "expected", *solvers, "measure again"],
            rows,
            "Twenty steps of a few particles. “goes on”: every number stays finite and momentum is conserved to roundoff; “stops”: the step fails and reports where. "
            "It is always an error to go on with a number that is not finite.",
            "firn bench stress",
            open=True,
        )
    ]
