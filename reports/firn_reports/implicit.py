# SPDX-License-Identifier: BSD-3-Clause
"""When semi-implicit steps pay: figures and tables of the suite `implicit`."""

import math
from collections.abc import Sequence

from .accuracy import draw_front
from .accuracy_tables import reaching
from .drawing import left_out, styles, who
from .page import Code, Figure, Table
from .results import Case, Results
from .results_tables import of_cases
from .style import MUTED, legend, log_axis, panel, plain, to_svg

# Errors that a user might ask for; the explicit runs themselves reach about 1 %.
TARGETS = (0.1, 0.05, 0.03, 0.02, 0.01)


def cost(results: Results) -> list[Case]:
    """The cases that measured the cost of a step."""
    return [c for c in results.suite("implicit") if c.name.startswith("cost")]


def error(results: Results) -> list[Case]:
    """The cases that measured an error."""
    return [c for c in results.suite("implicit") if c.name.startswith("error")]


def stiffness(case: Case) -> str:
    """Young's modulus as a label."""
    return f"E = {plain(case['youngs_modulus'])} Pa"


def is_explicit(case: Case) -> bool:
    """True if Δt is within the limit of the explicit method."""
    return case["r"] <= 1


def method(case: Case) -> str:
    """Solver, precision and tolerance, as a label."""
    return f"{who(case)}, " + (
        "explicit" if is_explicit(case) else f"implicit to {plain(case['tolerance'])}"
    )


def figures(results: Results) -> list[Figure]:
    """Cost, iterations, and run time against error."""
    return walls(cost(results)) + iterations(cost(results)) + fronts(error(results))


def small(cases: Sequence[Case]) -> list[Case]:
    """The cases of the block that every solver was asked for: the smallest."""
    fewest = min((c["particles"] for c in cases if c["particles"]), default=0)
    return [c for c in cases if c["particles"] == fewest]


def walls(cases: Sequence[Case]) -> list[Figure]:
    """Wall time of a simulated second, semi-implicit over explicit."""
    made = []
    shown = [c for c in small(cases) if c.value("implicit over explicit")]
    for name in sorted({who(c) for c in shown}):
        figure, axes = panel()
        mine = [c for c in shown if who(c) == name]
        for label, style in styles(
            stiffness(c) for c in sorted(mine, key=lambda c: c["youngs_modulus"])
        ).items():
            line = sorted((c for c in mine if stiffness(c) == label), key=lambda c: c["r"])
            axes.plot(
                [c["r"] for c in line],
                [c.median("implicit over explicit") for c in line],
                label=label,
                **style,
            )
        axes.axhline(1, color=MUTED, linestyle="--", linewidth=1)
        log_axis(axes, "x")
        log_axis(axes, "y")
        axes.set_xlabel("r = Δt / Δt explicit")
        axes.set_ylabel("implicit / explicit wall time")
        legend(axes, ncols=2)
        made.append(
            Figure(
                f"Cost of a simulated second, {name}",
                to_svg(figure),
                command=f"firn bench 'implicit/cost,{name.replace(', ', ',')}*'",
                caption="Below the dashed line larger steps are cheaper; whether they are accurate enough is another question. Tolerance 1e-3, "
                f"{small(cases)[0]['particles']} particles."
                + left_out(
                    (c for c in cases if who(c) == name), lambda c: f"{stiffness(c)}, r = {c['r']}"
                ),
            )
        )
    return made


def iterations(cases: Sequence[Case]) -> list[Figure]:
    """Iterations over r, small and large blocks, of the one solver that was asked for most."""
    counted = [
        c
        for c in cases
        if c.quantities.get("iterations 1e-3")
        and c["precision"] == "double"
        and c["solver"] != "reference"
    ]
    if not counted:
        return []
    figure, axes = panel(4.6, 3.4)
    names: dict[str, list[Case]] = {}
    for c in sorted(counted, key=lambda c: (c["youngs_modulus"], c["particles"])):
        names.setdefault(f"{stiffness(c)}, {plain(round(c['particles'] / 1000))} k", []).append(c)
    for label, style in styles(names).items():
        line = sorted(names[label], key=lambda c: c["r"])
        for quantity, shown in (("iterations 1e-3", label), ("iterations 1e-6", None)):
            axes.plot(
                [c["r"] for c in line],
                [c.quantities[quantity].median for c in line],
                label=shown,
                **style,
            )
    log_axis(axes, "x")
    log_axis(axes, "y")
    axes.set_xlabel("r = Δt / Δt explicit")
    axes.set_ylabel("iterations per step")
    legend(axes, ncols=2)
    return [
        Figure(
            "Iterations per step",
            to_svg(figure),
            command="firn bench 'implicit/cost,optimized,double*'",
            caption="Lower lines to a residual of 1e-3, upper ones to 1e-6. They grow with r, not with the number of particles.",
        )
    ]


def fronts(cases: Sequence[Case]) -> list[Figure]:
    """Run time against error, one figure per stiffness."""
    made = []
    shown = [c for c in cases if c.value("error") is not None and c.value("time")]
    for label in dict.fromkeys(
        stiffness(c) for c in sorted(shown, key=lambda c: c["youngs_modulus"])
    ):
        mine = [c for c in shown if stiffness(c) == label]
        names = sorted({method(c) for c in mine})
        figure, axes = panel(4.6, 3.3 + 0.17 * len(names))
        draw_front(axes, mine, method)
        made.append(
            Figure(
                f"Landing block, {label}: run time against error",
                to_svg(figure),
                command="firn bench 'implicit/error*'",
                caption="Displacements from free fall after 24 ms of impact, against explicit steps an eighth of the limit; r from ½ to 20. "
                "Lines: the front of each method; ringed: no other run is both faster and more accurate.",
            )
        )
    return made


def tables(results: Results) -> list[Table]:
    """Times to reach an error, and every case."""
    return (
        time_to_error(error(results))
        + of_cases(
            cost(results),
            "implicit_cost",
            "What a semi-implicit step costs",
            "firn bench 'implicit/cost*'",
        )
        + of_cases(
            error(results),
            "implicit_error",
            "Errors and times of the landing block",
            "firn bench 'implicit/error*'",
        )
    )


def time_to_error(cases: Sequence[Case]) -> list[Table]:
    """The fastest run that reaches each error, explicit and semi-implicit."""
    rows = []
    for label in dict.fromkeys(
        stiffness(c) for c in sorted(cases, key=lambda c: c["youngs_modulus"])
    ):
        mine = [c for c in cases if stiffness(c) == label and c.value("error") is not None]
        for target in TARGETS:
            kinds = sorted({(who(c), is_explicit(c)) for c in mine})
            found = [
                (kind, c)
                for kind in kinds
                if (c := reaching([m for m in mine if (who(m), is_explicit(m)) == kind], target))
            ]
            fastest = min((c.median("time") for _, c in found), default=math.nan)
            for (name, explicit), c in sorted(found, key=lambda f: f[1].median("time")):
                rows.append(
                    [
                        label,
                        target,
                        f"{name}, {'explicit' if explicit else 'implicit'}",
                        c.median("time"),
                        c.median("time") / fastest,
                        c.median("error"),
                        c["r"],
                        None if explicit else c["tolerance"],
                        Code(c.command),
                    ]
                )
    return (
        [
            Table(
                "implicit_time_to_error",
                "Time to reach a given error: explicit or semi-implicit",
                [
                    "stiffness",
                    "error asked for",
                    "method",
                    "wall time [s]",
                    "times the fastest",
                    "error reached",
                    "r",
                    "tolerance",
                    "measure again",
                ],
                rows,
                "The fastest run over r and tolerance whose error is small enough. A method without a row did not get there.",
                "firn bench 'implicit/error*'",
                open=True,
            )
        ]
        if rows
        else []
    )
