# SPDX-License-Identifier: BSD-3-Clause
"""Where it stops working: figures and tables of the suites `stability`, `stress` and `float`."""

import math
from collections.abc import Callable, Sequence

import numpy as np
from matplotlib.axes import Axes

from .drawing import styles
from .page import Figure, number
from .results import Case, Results
from .style import BAD, GOOD, INK, MUTED, SERIES, legend, log_axis, panel, to_svg

# No limit was looked for beyond (bench/suite_stability.cpp).
LARGEST_TRIED = 16


def limit(case: Case, quantity: str) -> float | None:
    """The limit, or None where none was found."""
    value = case.value(quantity)
    return value if value is not None and value < LARGEST_TRIED else None


# What is varied, where the axis is logarithmic, and how it is written.
AXES = {
    "E": "E [Pa]",
    "h": "h [m]",
    "alpha": "α",
    "beta": "β",
    "J_P": "J_P",
    "hardening at J_P = 0.8": "ξ at J_P = 0.8",
    "jitter": "jitter, in sub-cells",
    "beta at alpha = 0": "β at α = 0",
}
LOGARITHMIC = ("h", "particles per cell", "particles per cell, estimated volumes")
HARDENED = ("J_P", "hardening at J_P = 0.8")
NEVER = " No prediction: the particles do not sample every wave evenly."
LONE = "place of a lone particle"


def worst_limit(results: Results) -> tuple[float, str, Case] | None:
    """(distance from the prediction, which, case) where it is largest."""
    rows = [
        (
            abs(c.median("cfl") / predicted - 1),
            f"{AXES.get(c['varied'], c['varied'])}: {number(c['value'])}",
            c,
        )
        for c in results.suite("stability")
        if c.quotable and (predicted := expected(c)) is not None and limit(c, "cfl") is not None
    ]
    return max(rows, key=lambda row: row[0], default=None)


def stability(results: Results) -> list[Figure]:
    """A map of stable and unstable steps for each parameter that was varied."""
    cases = [c for c in results.suite("stability") if c.quotable]
    varied = list(
        dict.fromkeys(
            c["varied"]
            for c in sorted(
                cases,
                key=lambda c: (
                    c["varied"] not in AXES,
                    list(AXES).index(c["varied"]) if c["varied"] in AXES else 0,
                ),
            )
        )
    )
    made = seconds(cases)
    made += [
        stability_map(name, [c for c in cases if c["varied"] == name])
        for name in varied
        if name != "E" and not name.startswith((LONE, "E at"))
    ]
    return made + lone_particle([c for c in cases if c["varied"].startswith(LONE)])


def draw_tries(
    axes: Axes, cases: Sequence[Case], scale: Callable[[Case], float] = lambda case: 1.0
) -> None:
    """Every step that the bisections tried: a dot for a stable run, a cross for an unstable one."""
    for outcome, marker, colour in (("stable", "o", GOOD), ("unstable", "x", BAD)):
        points = [
            (c["value"], value * scale(c))
            for c in cases
            if outcome in c.quantities
            for value in c.quantities[outcome].values
        ]
        if points:
            axes.plot(
                *zip(*points, strict=True),
                linestyle="none",
                marker=marker,
                markersize=3.5,
                color=colour,
                alpha=0.6,
                label=f"tried, {outcome}",
            )


def stability_map(varied: str, cases: Sequence[Case]) -> Figure:
    """Steps tried over the parameter, the limit found, the limit predicted."""
    figure, axes = panel(4.6, 3.3)
    hardened = varied in HARDENED
    # Where hardening is varied, in units of the sound speed without it: so one sees what it costs.
    scale = (
        (lambda c: np.exp(-0.5 * c["hardening"] * (1 - c["J_P"]))) if hardened else (lambda c: 1.0)
    )

    def at(c: Case, quantity: str) -> float:
        """The limit of the case, scaled as the axis is."""
        found = limit(c, quantity)
        return math.nan if found is None else scale(c) * found

    found = [at(c, "cfl") for c in cases if limit(c, "cfl") is not None]
    top = 1.35 * max(found, default=LARGEST_TRIED)
    draw_tries(axes, cases, scale)
    for solver, style in styles(sorted({c["solver"] for c in cases})).items():
        line = sorted([c for c in cases if c["solver"] == solver], key=lambda c: c["value"])
        axes.plot(
            [c["value"] for c in line],
            [at(c, "cfl") for c in line],
            label=f"limit, {solver}",
            **style,
        )
    predicted = sorted(
        [c for c in cases if "predicted_cfl" in c.quantities], key=lambda c: c["value"]
    )
    if predicted:
        axes.plot(
            [c["value"] for c in predicted],
            [at(c, "predicted_cfl") for c in predicted],
            color=INK,
            linestyle="--",
            linewidth=1.2,
            label="predicted",
        )
    if varied in LOGARITHMIC:
        log_axis(axes, "x")
    axes.set_ylim(0, top)
    if hardened and found:
        log_axis(axes, "y")
        axes.set_ylim(0.5 * min(found), top)
    axes.set_xlabel(AXES.get(varied, varied))
    axes.set_ylabel("c Δt / h, c without hardening" if hardened else "c Δt / h")
    unlimited = [c["value"] for c in cases if limit(c, "cfl") is None]
    if unlimited:
        axes.plot(
            unlimited,
            [0.96 * top] * len(unlimited),
            linestyle="none",
            marker="^",
            markersize=9,
            color=MUTED,
            label=f"no limit up to {LARGEST_TRIED}",
        )
    legend(axes, ncols=2)
    return Figure(
        f"Stable steps over {AXES.get(varied, varied)}",
        to_svg(figure),
        command=f"firn bench 'stability/*,{varied}=*'",
        caption=off_by(predicted) if predicted else NEVER.strip(),
    )


def expected(case: Case) -> float | None:
    """Where the bisection should end.

    Growth is seen in 600 steps only up to 2 % beyond the limit itself.
    """
    return limit(case, "expected_cfl" if "expected_cfl" in case.quantities else "predicted_cfl")


def off_by(cases: Sequence[Case]) -> str:
    """How far limits lie from their predictions."""
    off = [
        abs(c.median("cfl") / predicted - 1)
        for c in cases
        if (predicted := expected(c)) is not None and limit(c, "cfl") is not None
    ]
    return (
        f"Largest distance of a limit from its prediction: {100 * max(off):.2g} %." if off else ""
    )


def seconds(cases: Sequence[Case]) -> list[Figure]:
    """Δt itself over E, one line per spacing: where a user looks up the step of a scene."""
    shown = [c for c in cases if c["varied"] == "E" or str(c["varied"]).startswith("E at")]
    if not shown:
        return []
    figure, axes = panel(4.6, 3.3)

    def in_seconds(c: Case) -> float:
        """Seconds per unit of c Δt / h."""
        return c.median("step") / c.median("cfl")

    draw_tries(axes, list(shown), in_seconds)
    for name, style in styles(
        f"h = {c['h']} m" for c in sorted(shown, key=lambda c: c["h"])
    ).items():
        line = sorted([c for c in shown if f"h = {c['h']} m" == name], key=lambda c: c["value"])
        axes.plot(
            [c["value"] for c in line],
            [c.median("step") for c in line],
            label=f"limit, {name}",
            **style,
        )
        axes.plot(
            [c["value"] for c in line],
            [c.median("predicted_cfl") * in_seconds(c) for c in line],
            color=INK,
            linestyle="--",
            linewidth=1.2,
            label=None if style["color"] != SERIES[0] else "predicted",
        )
    log_axis(axes, "x")
    log_axis(axes, "y")
    axes.set_xlabel("E [Pa]")
    axes.set_ylabel("Δt [s]")
    legend(axes, ncols=2)
    return [
        Figure(
            "Stable steps in seconds, over E and h",
            to_svg(figure),
            command="firn bench 'stability/*,E*'",
            caption=off_by(shown) + " ρ = 400 kg/m³, ν = 0.2, α = 0.95, 8 particles per cell.",
        )
    ]


def lone_particle(cases: Sequence[Case]) -> list[Figure]:
    """One particle with the mass of a full cell: its limit for a stated and an estimated volume."""
    if not cases:
        return []
    figure, axes = panel(4.6, 3.3)
    draw_tries(axes, [c for c in cases if c["solver"] != "reference"])

    def name_of(c: Case) -> str:
        """How the volume was found, and the solver if it is the reference."""
        return c["varied"].split(", ")[1] + (", reference" if c["solver"] == "reference" else "")

    for name, style in styles(
        name_of(c) for c in sorted(cases, key=lambda c: (c["solver"], c["varied"]))
    ).items():
        line = sorted([c for c in cases if name_of(c) == name], key=lambda c: c["value"])
        axes.plot([c["value"] for c in line], [c.median("cfl") for c in line], label=name, **style)
    for i, kind in enumerate(sorted({c["varied"] for c in cases})):
        line = sorted(
            [c for c in cases if c["varied"] == kind and c["solver"] != "reference"],
            key=lambda c: c["value"],
        )
        axes.plot(
            [c["value"] for c in line],
            [c.median("predicted_cfl") for c in line],
            color=INK,
            linestyle="--",
            linewidth=1.2,
            label="predicted" if i == 0 else None,
        )
    axes.set_ylim(0, 1.35 * max(c.median("cfl") for c in cases))
    axes.set_xlabel("place in the cell, along each axis [h]; 0: on a node")
    axes.set_ylabel("c Δt / h")
    legend(axes, ncols=2)
    return [
        Figure(
            "Stable steps of a lone particle, one per cell",
            to_svg(figure),
            command="firn bench 'stability/*,place*'",
            caption=off_by(cases)
            + " Step 2 takes the density of the snow from the particle's own nodes: a lone particle, or one that has left a surface, is "
            "given 8 to 10.3 h³ = 1/(ΣN²)³, whatever its mass, and therefore a third of the stable step. In the bulk, at one particle per cell, the estimate "
            "is right on average, and the limit stays near that of the wave (see the figure on estimated volumes).",
        )
    ]
