# SPDX-License-Identifier: BSD-3-Clause
"""Run time against error: figures and tables of the suite `accuracy`."""

from collections.abc import Callable, Sequence

import numpy as np
from matplotlib.axes import Axes

from .drawing import styles, who
from .page import Figure
from .results import Case, Results
from .style import INK, MARKERS, MUTED, SERIES, legend, log_axis, panel, plain, to_svg


def quoted(results: Results) -> list[Case]:
    """The cases of the suite that may be quoted."""
    return [c for c in results.suite("accuracy") if c.quotable]


def integration(case: Case) -> str:
    """ "explicit", or the kind and β of a semi-implicit step."""
    return str(case["integration"] or "explicit")


def is_explicit(case: Case) -> bool:
    """True if the case took explicit steps."""
    return integration(case) == "explicit"


def line_name(case: Case) -> str:
    """What stays the same along a line over h."""
    text = f"{who(case)}, α {case['alpha_policy']}"
    return text if is_explicit(case) else f"{text}, {integration(case)}, CFL {plain(case['cfl'])}"


def method(case: Case) -> str:
    """Solver, precision and kind of integration, whatever β: what a user chooses between."""
    return who(case) if is_explicit(case) else f"{who(case)}, implicit"


def command(problem: str) -> str:
    """What measures a problem again."""
    return f"firn bench 'accuracy/{problem}*'"


def problems(cases: Sequence[Case]) -> list[str]:
    """The problems of the cases, each once, in the order of the page."""
    return list(
        dict.fromkeys(
            c["problem"] for c in sorted(cases, key=lambda c: str(c["problem"]), reverse=True)
        )
    )


def figures(results: Results) -> list[Figure]:
    """Error over h and Δt, and run time against error, for each problem."""
    cases = quoted(results)
    made = []
    for problem in problems(cases):
        mine = [c for c in cases if c["problem"] == problem]
        explicit = [c for c in mine if is_explicit(c)]
        made += error_over_h(problem, [c for c in explicit if c["cfl"] == 0.4])
        if len({c["cfl"] for c in explicit}) > 1:
            made += error_over_step(problem, explicit)
        made.append(work_precision(problem, mine))
    return made


def best_covered(cases: Sequence[Case], key: str) -> list[Case]:
    """The cases of the one solver and precision that was asked for most values of `key`: one
    suffices to show the order of the method, the others lie upon it."""
    groups: dict[tuple[str, str], list[Case]] = {}
    for c in cases:
        groups.setdefault((c["solver"], c["precision"]), []).append(c)
    if not groups:
        return []
    return max(
        groups.values(),
        key=lambda g: (len({c[key] for c in g}), g[0]["precision"] == "double", g[0]["solver"]),
    )


def draw_lines(axes: Axes, cases: Sequence[Case], x: str) -> None:
    """Errors over the parameter `x`, one line per method."""
    for name, style in styles(line_name(c) for c in sorted(cases, key=line_name)).items():
        line = sorted([c for c in cases if line_name(c) == name], key=lambda c: c[x])
        axes.plot([c[x] for c in line], [c.median("error") for c in line], label=name, **style)


def error_over_h(problem: str, cases: Sequence[Case]) -> list[Figure]:
    """Error over the spacing, with slopes of order 1 and 2."""
    shown = best_covered(cases, "h")
    if not shown:
        return []
    figure, axes = panel(4.6, 3.4)
    draw_lines(axes, shown, "h")
    h = np.array(sorted({c["h"] for c in shown}))
    if len(h) > 1:
        top = max(c.median("error") for c in shown)
        for order, dash in ((1, ":"), (2, "--")):
            axes.plot(
                h,
                0.7 * top * (h / h[-1]) ** order,
                color=MUTED,
                linewidth=1,
                linestyle=dash,
                label=f"order {order}",
            )
    log_axis(axes, "x", 2)
    log_axis(axes, "y")
    axes.set_xlabel("h [m]")
    axes.set_ylabel("relative error of u")
    legend(axes, ncols=2)
    return [
        Figure(
            f"{problem}: error over h",
            to_svg(figure),
            command=command(problem),
            caption=f"Explicit, CFL 0.4; {len(h)} resolutions.",
        )
    ]


def error_over_step(problem: str, cases: Sequence[Case]) -> list[Figure]:
    """Error over Δt at the number of cells with most values of Δt."""
    counts: dict[int, set[float]] = {}
    for c in cases:
        counts.setdefault(c["cells"], set()).add(c["cfl"])
    cells = max(counts, key=lambda n: len(counts[n]))
    shown = best_covered([c for c in cases if c["cells"] == cells], "cfl")
    lines = {line_name(c) for c in shown}
    shown = [c for c in shown if sum(line_name(o) == line_name(c) for o in shown) > 1]
    if not lines or not shown:
        return []
    figure, axes = panel(4.6, 3.4)
    draw_lines(axes, shown, "cfl")
    log_axis(axes, "x")
    log_axis(axes, "y")
    axes.set_xlabel("c Δt / h")
    axes.set_ylabel("relative error of u")
    legend(axes, ncols=2)
    return [
        Figure(
            f"{problem}: error over Δt, {cells} cells",
            to_svg(figure),
            command=command(problem),
            caption="With a fixed α < 1 a smaller Δt damps more per second and the error grows.",
        )
    ]


def pareto(points: Sequence[tuple[float, float]]) -> list[int]:
    """Indices of the points that no other one beats in both coordinates (smaller is better)."""
    order = sorted(range(len(points)), key=lambda i: points[i])
    front, lowest = [], np.inf
    for i in order:
        if points[i][1] < lowest:
            front.append(i)
            lowest = points[i][1]
    return front


def draw_front(axes: Axes, cases: Sequence[Case], method: Callable[[Case], str]) -> None:
    """Every run as a mark, the front of each method as a line, the front of all ringed."""
    for i, name in enumerate(sorted({method(c) for c in cases})):
        points = [(c.median("time"), c.median("error")) for c in cases if method(c) == name]
        colour, marker = SERIES[i % 8], MARKERS[i % 8]
        axes.plot(
            *zip(*points, strict=True),
            color=colour,
            marker=marker,
            linestyle="none",
            markersize=3.5,
            alpha=0.45,
        )
        front = [points[k] for k in pareto(points)]
        axes.plot(
            *zip(*front, strict=True),
            color=colour,
            marker=marker,
            linewidth=1.2,
            drawstyle="steps-post",
            label=name,
        )
    points = [(c.median("time"), c.median("error")) for c in cases]
    front = [points[k] for k in pareto(points)]
    axes.plot(
        *zip(*front, strict=True),
        linestyle="none",
        marker="o",
        markersize=10,
        fillstyle="none",
        color=INK,
        label="Pareto front of all",
    )
    log_axis(axes, "x")
    log_axis(axes, "y")
    axes.set_xlabel("wall time [s]")
    axes.set_ylabel("relative error of u")
    legend(axes, ncols=2)


def work_precision(problem: str, cases: Sequence[Case]) -> Figure:
    """Run time against error of every run of a problem."""
    cases = [c for c in cases if c.value("time")]
    figure, axes = panel(4.6, 3.3 + 0.17 * len({method(c) for c in cases}))
    draw_front(axes, cases, method)
    return Figure(
        f"{problem}: run time against error",
        to_svg(figure),
        command=command(problem),
        caption="Down and left is better. Pale: every run, over h, Δt, α and β; lines: the front of each method; ringed: no other run is both faster and more accurate.",
    )
