"""The figures of a results page, small panels that say one thing each."""

from collections.abc import Callable, Iterable, Sequence
from typing import Any, TypeAlias

import numpy as np

from .baseline import Change
from .page import Figure
from .results import Case, Results
from .style import (
    BAD,
    DASHES,
    GOOD,
    GRID,
    INK,
    MARKERS,
    MUTED,
    SERIES,
    legend,
    log_axis,
    panel,
    plain,
    to_svg,
)

# What a plain cubic-spline step computes per particle (bench/needed_work.hpp): 64 nodes times
# (1 mass + 3 momentum + 9 force in the scatter, 6 velocity + 9 gradient in the gather)
# multiply-adds, 8 for the products of weights. The update of F (some 500) is left out: it depends
# on what yields.
PLAIN_FLOP = 64 * (2 * 28 + 8)
# x, v, F_E, F_P read and written, m and V_0 read: numbers that any step must move if nothing stays
# in cache.
PLAIN_NUMBERS = 2 * 24 + 2


# (label, value, low, high) of a horizontal bar.
Bar: TypeAlias = tuple[str, float, float, float]


def left_out(cases: Iterable[Case], name: Callable[[Case], str] = lambda case: case.name) -> str:
    """What a caption adds on cases that a figure does not show; nothing if it shows all."""
    names = [name(c) for c in cases if c.status == "noisy"]
    more = (
        f" and {len(names) - 4} more, named under “Noise of this machine”" if len(names) > 4 else ""
    )
    return f" Too noisy to quote: {'; '.join(names[:4])}{more}." if names else ""


def who(case: Case, threads: bool = False) -> str:
    """Solver and precision, and threads if asked for, as a label."""
    text = f"{case['solver']}, {case['precision']}"
    return f"{text}, {case['threads']} T" if threads else text


def styles(names: Iterable[str]) -> dict[str, dict[str, Any]]:
    """Colour, marker and dashes for each name, in order."""
    return {
        name: {"color": SERIES[i % 8], "marker": MARKERS[i % 8], "linestyle": DASHES[i % 8]}
        for i, name in enumerate(dict.fromkeys(names))
    }


def bars(
    rows: Sequence[Bar],
    xlabel: str,
    log: bool = False,
    zero: bool = False,
    marks: Sequence[float] = (),
    ticks: Sequence[float | None] = (),
    text: Callable[[float], str] = lambda value: plain(float(f"{value:.3g}")),
) -> str:
    """Horizontal bars as SVG, the value written at the end of each.

    `rows`: (label, value, low, high); `marks`: dashed lines through all bars; `ticks`: a value
    beside each bar, or None.
    """
    figure, axes = panel(4.6, 0.75 + 0.3 * max(len(rows), 2))
    lowest, highest = (
        min([0, *(row[2] for row in rows)]),
        max([0, *(row[3] for row in rows), *(t for t in ticks if t)]),
    )
    for y, (_, value, low, high) in enumerate(rows):
        # The number stands behind its bar, and behind a dashed line that it would cross.
        tick = ticks[y] if y < len(ticks) else None
        reach = max(value, high, tick or 0)
        end = max(
            [reach, 0] + [x for x in marks if value <= x <= reach + 0.25 * (highest - lowest)]
        )
        colour = BAD if zero and value < 0 else SERIES[0]
        axes.barh(y, value, height=0.62, color=colour, alpha=0.85)
        axes.plot([low, high], [y, y], color=INK, linewidth=1.2)
        if tick:
            axes.plot(
                [tick, tick],
                [y - 0.38, y + 0.38],
                color=SERIES[1],
                linewidth=2.5,
                solid_capstyle="butt",
            )
        axes.annotate(
            text(value),
            (end, y),
            xytext=(4, 0),
            textcoords="offset points",
            va="center",
            fontsize=8.5,
        )
    for x in marks:
        axes.axvline(x, color=MUTED, linewidth=1, linestyle="--")
    axes.set_yticks(range(len(rows)), [row[0] for row in rows])
    axes.set_ylim(len(rows) - 0.4, -0.6)
    axes.set_xlabel(xlabel, loc="right")
    axes.grid(False, axis="y")
    axes.tick_params(axis="y", length=0)
    if log:
        log_axis(axes, "x")
    else:
        # Room for the number behind the longest bar.
        axes.set_xlim(lowest, highest + 0.24 * (highest - lowest))
    axes.margins(x=0.16)
    return to_svg(figure)


def with_quartiles(case: Case, name: str, scale: float = 1.0) -> tuple[float, float, float]:
    """(median, first quartile, third quartile) of a quantity, times `scale`."""
    low, high = case.quantities[name].quartiles
    return case.median(name) * scale, low * scale, high * scale


def speed(results: Results) -> list[Figure]:
    """Rate over size, times faster than the reference, threads and sizes."""
    made = []
    cases = [c for c in results.suite("steps") if c.quotable]
    for deformation in ("plastic", "elastic"):
        chosen = [c for c in cases if c["deformation"] == deformation]
        if not chosen:
            continue
        figure, axes = panel()
        look = styles(
            who(c, True)
            for c in sorted(chosen, key=lambda c: (c["solver"], c["precision"], c["threads"]))
        )
        for name, style in look.items():
            line = sorted([c for c in chosen if who(c, True) == name], key=lambda c: c["particles"])
            values = np.array([with_quartiles(c, "rate", 1e-6) for c in line])
            axes.errorbar(
                [c["particles"] for c in line],
                values[:, 0],
                yerr=np.abs(values[:, 1:].T - values[:, 0]),
                label=name,
                capsize=2,
                **style,
            )
        log_axis(axes, "x")
        log_axis(axes, "y")
        axes.set_xlabel("particles")
        axes.set_ylabel("million particle-steps per second")
        legend(axes, ncols=2)
        made.append(
            Figure(
                f"Rate over size, {deformation}",
                to_svg(figure),
                command=f"firn bench 'steps/*,{deformation},*'",
                caption="Level lines: the cost per particle does not grow with the size."
                + left_out(c for c in results.suite("steps") if c["deformation"] == deformation),
            )
        )
    ratios = [c for c in results.suite("speedup") if c.quotable]
    if ratios:
        rows = [
            (f"{who(c, True)}, {c['deformation']}", *with_quartiles(c, "speedup"))
            for c in sorted(ratios, key=lambda c: c.name)
        ]
        made.append(
            Figure(
                "Times faster than the reference",
                bars(rows, "times the reference (double, 1 thread)"),
                command="firn bench speedup",
                caption="Repetitions of both solvers took turns, so that a slow minute of the machine affects both."
                + left_out(results.suite("speedup")),
            )
        )
    return made + scaling(results)


# Of n solvers with one thread each that step at the same time: what the machine gives to n threads.
COPIES = "efficiency of independent copies"


def scaling(results: Results) -> list[Figure]:
    """Threads and sizes as ratios inside one interleaved run."""
    cases = sorted(
        results.suite("scaling"), key=lambda c: (c["precision"], c["deformation"], c["particles"])
    )

    def name(c: Case) -> str:
        """Label of a case."""
        return f"{c['precision']}, {c['deformation']}, {plain(c['particles'] / 1e6)} M"

    made = []
    threads = [c for c in cases if c.value("efficiency") is not None]
    if threads:
        rows = [
            (f"{name(c)}, {c['threads']} T", *with_quartiles(c, "efficiency", c["threads"]))
            for c in threads
        ]
        copies = [c.value(COPIES) and c.value(COPIES) * c["threads"] for c in threads]
        told = (
            ", in rounds with fresh memory; medians and quartiles of the rounds. Thick line: what as many one-thread solvers reach that share nothing, so what the machine gave in the same seconds"
            if any(copies)
            else ""
        )
        made.append(
            Figure(
                "Speed-up by threads",
                bars(
                    rows,
                    "times one thread",
                    marks=sorted({c["threads"] for c in threads}),
                    ticks=copies,
                ),
                command="firn bench scaling",
                caption=f"One thread and all threads took turns{told}. Dashed: the number of threads."
                + left_out(c for c in cases if c["threads"] > 1),
            )
        )
    sizes = [c for c in cases if c.value("growth") is not None]
    if sizes:
        rows = [(name(c), *with_quartiles(c, "growth")) for c in sizes]
        made.append(
            Figure(
                "Cost per particle against 100 000 particles",
                bars(rows, "times the cost of 100 000", marks=[1]),
                command="firn bench scaling",
                caption="One thread; the small and the large block took turns."
                + left_out(c for c in cases if c["threads"] == 1),
            )
        )
    return made


def peak(results: Results, precision: str, threads: int = 1) -> float | None:
    """FMA peak [flop/s] that the probe measured, None without a probe."""
    probe = results.find("roofline", f"fma_{precision},{threads}T")
    return probe.quantities["rate"].median if probe else None


def roofline_points(results: Results) -> list[tuple[Case, float, float, float]]:
    """(case, flop/s, flop/byte, share of the peak) of each whole step, by the plain count."""
    points = []
    for case in results.suite("steps"):
        ceiling = peak(results, case["precision"], case["threads"])
        if case.value("rate") is None or not ceiling:
            continue
        size = 4 if case["precision"] == "float" else 8
        rate = case.median("rate") * PLAIN_FLOP
        points.append((case, rate, PLAIN_FLOP / (PLAIN_NUMBERS * size), rate / ceiling))
    return points


def best_share_of_peak(results: Results) -> tuple[float, str] | None:
    """(share, who) of the step nearest the FMA peak on one thread."""
    points = [p for p in roofline_points(results) if p[0]["threads"] == 1]
    top = max(points, key=lambda p: p[3], default=None)
    return (top[3], f"{who(top[0])}, {top[0]['deformation']}") if top else None


def widest(results: Results) -> str:
    """ "AVX3 (512 bits)": what the probes, and so the ceilings, were measured with."""
    name = next(
        (str(c["instruction_set"]) for c in results.suite("roofline") if c["instruction_set"]), ""
    )
    bits = {
        "AVX3": 512,
        "AVX3_DL": 512,
        "AVX3_ZEN4": 512,
        "AVX2": 256,
        "SSE4": 128,
        "SSSE3": 128,
        "NEON": 128,
    }.get(name)
    return f"{name} ({bits} bits)" if bits else name


def roofline(results: Results) -> list[Figure]:
    """Ceilings of one thread and where whole steps lie below them, by precision."""
    band = results.find("roofline", "triad,1T")
    if not band:
        return []
    points = [p for p in roofline_points(results) if p[0]["threads"] == 1]
    made = []
    for precision in ("float", "double"):
        ceiling = peak(results, precision)
        if not ceiling:
            continue
        figure, axes = panel(4.6, 3.3)
        bandwidth = band.quantities["rate"].median
        mine = [p for p in points if p[0]["precision"] == precision]
        lowest = min([ceiling / 30, *(p[1] / 2 for p in mine)])
        x = np.logspace(np.log10(lowest / bandwidth), 2.3, 200)
        axes.plot(
            x,
            np.minimum(ceiling, bandwidth * x) / 1e9,
            color=INK,
            label=f"1 thread, {widest(results)}",
        )
        axes.annotate(
            f"FMA peak {ceiling / 1e9:.0f} Gflop/s",
            (x[-1], ceiling / 1e9),
            xytext=(0, 3),
            textcoords="offset points",
            ha="right",
            va="bottom",
            fontsize=8.5,
        )
        axes.annotate(
            f"triad {bandwidth / 1e9:.1f} GB/s",
            (3 * x[0], 3 * lowest / 1e9),
            xytext=(8, 0),
            textcoords="offset points",
            va="center",
            fontsize=8.5,
        )
        look = styles(f"{p[0]['solver']}, {p[0]['deformation']}" for p in mine)
        for name, style in look.items():
            # The largest block of each: the sizes lie upon one another.
            point = max(
                (p for p in mine if f"{p[0]['solver']}, {p[0]['deformation']}" == name),
                key=lambda p: p[0]["particles"],
            )
            axes.plot(
                [point[2]],
                [point[1] / 1e9],
                label=f"{name}: {100 * point[3]:.2g} %",
                **{**style, "linestyle": "none", "markersize": 6},
            )
        log_axis(axes, "x")
        log_axis(axes, "y")
        axes.set_ylim(lowest / 1e9, 2 * ceiling / 1e9)
        axes.set_xlabel("flop per byte, plain count")
        axes.set_ylabel("Gflop/s")
        legend(axes, ncols=2)
        made.append(
            Figure(
                f"Roofline, {precision}",
                to_svg(figure),
                command="firn bench roofline steps",
                caption=f"{PLAIN_FLOP} flop and {PLAIN_NUMBERS} numbers moved per particle-step by the plain count; the largest block of each. "
                "Percentages are of the FMA peak. To the right of the bend, arithmetic is the limit.",
            )
        )
    return made


def stages(results: Results) -> list[Figure]:
    """Time of each stage, one figure per solver."""
    made = []
    for case in sorted(results.suite("stages"), key=lambda c: c.name):
        rows = [
            (name.replace("_", " "), *np.maximum([q.median, *q.quartiles], 0))
            for name, q in case.quantities.items()
            if name != "whole step" and q.units == "ns"
        ]
        order = [
            "rasterize",
            "volumes",
            "grid forces",
            "grid velocities",
            "grid collisions",
            "integration",
            "deformation",
            "particle velocities",
            "particle collisions",
            "positions",
        ]
        rows.sort(
            key=lambda row: next((i for i, name in enumerate(order) if row[0].startswith(name)), 99)
        )
        whole = case.quantities.get("whole step")
        if not case.quotable or whole is None:
            continue
        rows.append(("all stages", *[sum(r[i] for r in rows) for i in (1, 2, 3)]))
        rows.append(("whole step", whole.median, *whole.quartiles))
        made.append(
            Figure(
                f"{who(case)}, {case['deformation']}",
                bars(rows, "ns per particle"),
                command=case.command,
                caption="“whole step”: the solver's fastest path, which may do several stages at once.",
            )
        )
    return made


def skips(results: Results) -> list[Figure]:
    """What each skip saves, one figure per precision."""
    cases = [c for c in results.suite("skips") if c.quotable]
    made = []
    for precision in ("float", "double"):
        mine = [c for c in cases if c["precision"] == precision]
        if not mine:
            continue
        rows = [
            (f"{c['skip']}: {c['situation']}", *with_quartiles(c, "saved", 100))
            for c in sorted(mine, key=lambda c: (c["skip"], c["situation"]))
        ]
        made.append(
            Figure(
                f"Saved by each skip, {precision}",
                bars(rows, "% of the step saved", zero=True, marks=[0]),
                command=f"firn bench 'skips/*,{precision},*'",
                caption="Lines: the middle half of 27 pairs of runs or more."
                + left_out(
                    (c for c in results.suite("skips") if c["precision"] == precision),
                    lambda c: f"{c['skip']}: {c['situation']}",
                ),
            )
        )
    return made


def snowball(results: Results) -> list[Figure]:
    """Bands over seeds: median and the range of all of them, never an order."""
    cases = [c for c in results.suite("snowball") if c.quotable]
    made = []
    for name in dict.fromkeys(key for c in cases for key in c.quantities):
        figure, axes = panel()
        names = list(dict.fromkeys(who(c) for c in sorted(cases, key=who)))
        for i, (solver, style) in enumerate(styles(names).items()):
            line = sorted([c for c in cases if who(c) == solver], key=lambda c: c["resolution"])
            # Side by side: float and double lie upon each other.
            x = np.array([c["resolution"] for c in line]) + 0.12 * (i - 0.5 * (len(names) - 1))
            values = [c.quantities[name].values for c in line]
            middle, low, high = (
                np.array([f(v) for v in values]) for f in (np.median, np.min, np.max)
            )
            axes.fill_between(x, low, high, color=style["color"], alpha=0.13, linewidth=0)
            axes.errorbar(
                x, middle, yerr=[middle - low, high - middle], label=solver, capsize=3, **style
            )
        quantity = cases[0].quantities[name]
        resolutions = sorted({c["resolution"] for c in cases})
        axes.set_xticks(resolutions)
        axes.set_xlim(resolutions[0] - 0.7, resolutions[-1] + 0.7)
        axes.set_xlabel("spacings per radius of the ball")
        axes.set_ylabel(f"{name} [{quantity.units}]" if quantity.units != "1" else name)
        legend(axes, ncols=2)
        made.append(
            Figure(
                quantity.meaning[:1].upper() + quantity.meaning[1:],
                to_svg(figure),
                command="firn bench snowball",
                caption="Median and range over five seeds.",
            )
        )
    return made


def targets(results: Results) -> list[Figure]:
    """Time and share of the peak of each instruction set."""
    every = results.suite("targets")
    cases = sorted(
        [c for c in every if c.quotable],
        key=lambda c: (c["deformation"], c["precision"], c["target"]),
    )
    if not cases:
        return []

    def name(c: Case) -> str:
        """Label of a case."""
        return f"{c['target']}, {c['precision']}, {c['deformation']}"

    made = [
        Figure(
            "Time per particle and step",
            bars([(name(c), *with_quartiles(c, "time")) for c in cases], "ns"),
            command="firn bench targets",
            caption="The same code, 100 000 particles, one thread." + left_out(every, name),
        )
    ]
    for count, (what, why) in COUNTS.items():
        shares = [
            (name(c), *with_quartiles(c, f"FMA peak, {count} count", 100))
            for c in cases
            if f"FMA peak, {count} count" in c.quantities
        ]
        if shares:
            made.append(
                Figure(
                    f"Share of each instruction set's own peak, {count} count",
                    bars(shares, f"% of its FMA peak, {count} count"),
                    command="firn bench targets",
                    caption=f"{what}, over what the same instruction set reached right after each repetition: {why}.",
                )
            )
    return made


# What the shares of the FMA peak count (bench/needed_work.hpp), and what it is good for.
COUNTS = {
    "factored": (
        "Multiply-adds, additions and products that the factored step needs (1536 elastic, 1826 plastic per particle, each counted once)",
        "how busy the units are",
    ),
    "plain": (
        f"{PLAIN_FLOP} flop that plain transfers take per particle (this solver takes fewer)",
        "how fast it is, in a measure that other codes share",
    ),
}


def kernels(results: Results) -> list[Figure]:
    """Time of each kernel, one figure per kernel."""
    made = []
    every = results.suite("kernels")
    cases = [c for c in every if c.quotable]

    def name(c: Case) -> str:
        """Label of a case."""
        return ", ".join(str(c[key]) for key in ("code", "precision", "target") if c[key])

    for kernel in dict.fromkeys(
        c["kernel"] for c in sorted(every, key=lambda c: kernel_order(c["kernel"]))
    ):
        mine = sorted((c for c in cases if c["kernel"] == kernel), key=lambda c: c.median("time"))
        if not mine:
            continue
        rows = [(name(c), *with_quartiles(c, "time")) for c in mine]
        made.append(
            Figure(
                str(kernel),
                bars(
                    rows, "ns per item", log=max(r[1] for r in rows) > 20 * min(r[1] for r in rows)
                ),
                command=f"firn bench 'kernels/{kernel},*'",
                caption=left_out((c for c in every if c["kernel"] == kernel), name).strip(),
            )
        )
    return made


# In the order of a step, then what a particle needs; others behind.
KERNELS = (
    "weights",
    "sort into blocks",
    "P2G, mass and momentum",
    "P2G, forces",
    "grid update",
    "collision",
    "G2P, gradient and F",
    "G2P, velocities",
    "positions and movers",
    "SVD",
    "polar",
    "box test",
    "stress",
    "return map",
    "Hessian action",
)


def kernel_order(kernel: Any) -> tuple[int, str]:
    """Sorts kernels in the order of KERNELS."""
    return next(
        (i for i, name in enumerate(KERNELS) if str(kernel).startswith(name)), len(KERNELS)
    ), str(kernel)


def verification(results: Results) -> list[Figure]:
    """Largest error of each topic, one figure per solver verified."""
    made = []
    for subject, verdict in results.verify.items():
        worst: dict[str, float] = {}
        for row in verdict["rows"]:
            worst[row["topic"]] = max(worst.get(row["topic"], 1e-6), row["error"])
        figure, axes = panel(4.6, 0.9 + 0.26 * max(len(worst), 2))
        for y, value in enumerate(worst.values()):
            axes.plot(
                [1e-6, value],
                [y, y],
                color=GOOD if value <= 1 else BAD,
                linewidth=5,
                solid_capstyle="butt",
            )
        axes.axvline(1, color=BAD, linestyle="--", linewidth=1)
        axes.set_yticks(range(len(worst)), list(worst))
        axes.set_ylim(len(worst) - 0.5, -0.5)
        log_axis(axes, "x")
        axes.set_xlabel("largest error, in units of its bound", loc="right")
        axes.grid(False, axis="y")
        made.append(
            Figure(
                f"{subject}: {verdict['verdict']}",
                to_svg(figure),
                command=verdict["command"],
                caption="Topics without a bar are exact: equal bits, or a yes-or-no check.",
            )
        )
    return made


def changes(changes: Sequence[Change]) -> list[Figure]:
    """The largest changes against the baseline."""
    shown = [c for c in changes if c.kind in ("worse", "better")]
    shown = sorted(shown, key=lambda c: -abs(np.log(c.ratio)))[:14]
    if not shown:
        return []
    figure, axes = panel(4.6, 0.8 + 0.3 * len(shown))
    for y, c in enumerate(shown):
        value = 100 * (c.ratio - 1)
        axes.barh(y, value, height=0.6, color=BAD if c.kind == "worse" else GOOD)
        axes.plot(
            [value - 100 * c.uncertainty, value + 100 * c.uncertainty],
            [y, y],
            color=INK,
            linewidth=1.2,
        )
    axes.axvline(0, color=GRID)
    axes.set_yticks(range(len(shown)), [f"{c.case.suite} {c.case.name}"[:40] for c in shown])
    axes.set_ylim(len(shown) - 0.4, -0.6)
    axes.set_xlabel("% worse")
    axes.grid(False, axis="y")
    return [
        Figure(
            "Largest changes",
            to_svg(figure),
            caption="Left of zero is better. Lines: ± three standard errors of the medians.",
        )
    ]


def noise(results: Results) -> list[Figure]:
    """The fixed loop over the whole run."""
    loops = [c for c in results.cases if len(c.calibration)]
    if not loops:
        return []
    # In the order of time where the file says it.
    loops.sort(key=lambda c: (c.finished, c.suite, c.name))
    figure, axes = panel()
    typical = np.median(np.concatenate([c.calibration for c in loops]))
    for noisy, colour, label in (
        (False, SERIES[0], "quoted cases"),
        (True, BAD, "cases too noisy to quote"),
    ):
        mine = [
            (i, x)
            for i, c in enumerate(loops)
            if (c.status == "noisy") == noisy
            for x in c.calibration
        ]
        if mine:
            axes.plot(
                [i for i, _ in mine],
                [x / typical for _, x in mine],
                linestyle="none",
                marker=".",
                markersize=3,
                color=colour,
                label=label,
            )
    axes.axhline(1, color=MUTED, linewidth=1)
    axes.set_xlabel("case, in the order of measurement" if loops[0].finished else "case")
    axes.set_ylabel("fixed loop / its median")
    legend(axes, ncols=2)
    return [
        Figure(
            "The fixed loop",
            to_svg(figure),
            caption=f"Median {plain(1e3 * typical)} ms.",
            command="firn bench",
        )
    ]
