"""The figures of a results page, small panels that say one thing each."""

import numpy as np

from .page import Figure
from .style import BAD, DASHES, GOOD, GRID, INK, MARKERS, MUTED, SERIES, legend, log_axis, panel, plain, to_svg

# What a plain cubic-spline step computes per particle: 64 nodes times (1 mass + 3 momentum + 9 force in the
# scatter, 6 velocity + 9 gradient in the gather) multiply-adds, 8 for the products of weights. The update of
# F (some 500) is left out: it depends on what yields.
PLAIN_FLOP = 64 * (2 * 28 + 8)
# x, v, F_E, F_P read and written, m and V_0 read: numbers that any step must move if nothing stays in cache.
PLAIN_NUMBERS = 2 * 24 + 2


def first_command(cases):
    """One command that measures all the cases of a figure again."""
    suites = {case.suite for case in cases}
    return "firn bench " + " ".join(sorted(suites)) if suites else ""


def who(case, threads=False):
    text = f"{case['solver']}, {case['precision']}"
    return f"{text}, {case['threads']} T" if threads else text


def styles(names):
    return {name: {"color": SERIES[i % 8], "marker": MARKERS[i % 8], "linestyle": DASHES[i % 8]} for i, name in enumerate(dict.fromkeys(names))}


def bars(rows, xlabel, log=False, zero=False, marks=()):
    """Horizontal bars: (label, value, low, high), the value written at the end."""
    figure, axes = panel(4.6, 0.75 + 0.3 * max(len(rows), 2))
    for y, (label, value, low, high) in enumerate(rows):
        colour = BAD if zero and value < 0 else SERIES[0]
        axes.barh(y, value, height=0.62, color=colour, alpha=0.85)
        axes.plot([low, high], [y, y], color=INK, linewidth=1.2)
        axes.annotate(plain(float(f"{value:.3g}")), (max(value, high, 0), y), xytext=(4, 0), textcoords="offset points", va="center", fontsize=8.5)
    for x in marks:
        axes.axvline(x, color=MUTED, linewidth=1, linestyle="--")
    axes.set_yticks(range(len(rows)), [row[0] for row in rows])
    axes.set_ylim(len(rows) - 0.4, -0.6)
    axes.set_xlabel(xlabel, loc="right")
    axes.grid(False, axis="y")
    if log:
        log_axis(axes, "x")
    axes.margins(x=0.16)
    return to_svg(figure)


def with_quartiles(case, name, scale=1.0):
    low, high = case.quantities[name].quartiles
    return case.value(name) * scale, low * scale, high * scale


def speed(results):
    made = []
    cases = [c for c in results.suite("steps") if c.quotable]
    for deformation in ("plastic", "elastic"):
        chosen = [c for c in cases if c["deformation"] == deformation]
        if not chosen:
            continue
        figure, axes = panel()
        look = styles(who(c, True) for c in sorted(chosen, key=lambda c: (c["solver"], c["precision"], c["threads"])))
        for name, style in look.items():
            line = sorted([c for c in chosen if who(c, True) == name], key=lambda c: c["particles"])
            values = np.array([with_quartiles(c, "rate", 1e-6) for c in line])
            axes.errorbar([c["particles"] for c in line], values[:, 0], yerr=np.abs(values[:, 1:].T - values[:, 0]), label=name, capsize=2, **style)
        log_axis(axes, "x")
        log_axis(axes, "y")
        axes.set_xlabel("particles")
        axes.set_ylabel("million particle-steps per second")
        legend(axes, ncols=2)
        made.append(Figure(f"Rate over size, {deformation}", to_svg(figure), command=first_command(chosen),
                           caption="Level lines: the cost per particle does not grow with the size."))
    ratios = [c for c in results.suite("speedup") if c.quotable]
    if ratios:
        rows = [(f"{who(c, True)}, {c['deformation']}", *with_quartiles(c, "speedup")) for c in sorted(ratios, key=lambda c: c.name)]
        made.append(Figure("Times faster than the reference", bars(rows, "times the reference (double, 1 thread)"), command=first_command(ratios),
                           caption="Repetitions of both solvers took turns, so that a slow minute of the machine hits both."))
    made += scaling(cases)
    return made


def scaling(cases):
    multi = [c for c in cases if c["threads"] > 1]
    rows = []
    for c in sorted(multi, key=lambda c: c.name):
        one = next((o for o in cases if o["threads"] == 1 and all(o[k] == c[k] for k in ("solver", "precision", "deformation", "particles"))), None)
        if one:
            rows.append((f"{who(c, True)}, {c['deformation']}, {plain(c['particles'] / 1e6)} M", *(v / one.value("rate") for v in with_quartiles(c, "rate"))))
    if not rows:
        return []
    return [Figure("Speed-up by threads", bars(rows, "rate / rate of one thread", marks=sorted({c["threads"] for c in multi})),
                   command=first_command(multi), caption="Dashed: the number of threads.")]


def peak(results, precision, threads=1):
    probe = results.find("roofline", f"fma_{precision},{threads}T")
    return probe.quantities["rate"].median if probe else None


def roofline_points(results):
    """(case, flop/s, flop/byte, share of the peak) of each whole step, by the plain count."""
    points = []
    for case in results.suite("steps"):
        ceiling = peak(results, case["precision"], case["threads"])
        if case.value("rate") is None or not ceiling:
            continue
        size = 4 if case["precision"] == "float" else 8
        rate = case.value("rate") * PLAIN_FLOP
        points.append((case, rate, PLAIN_FLOP / (PLAIN_NUMBERS * size), rate / ceiling))
    return points


def best_share_of_peak(results):
    points = [p for p in roofline_points(results) if p[0]["threads"] == 1]
    top = max(points, key=lambda p: p[3], default=None)
    return (top[3], f"{who(top[0])}, {top[0]['deformation']}") if top else None


def roofline(results):
    band = results.find("roofline", "triad,1T")
    if not band:
        return []
    points = [p for p in roofline_points(results) if p[0]["threads"] == 1]
    made = []
    for precision in ("float", "double"):
        ceiling = peak(results, precision)
        if not ceiling:
            continue
        figure, axes = panel()
        x = np.logspace(-1, 3, 200)
        bandwidth = band.quantities["rate"].median
        axes.plot(x, np.minimum(ceiling, bandwidth * x) / 1e9, color=INK, label="this machine, 1 thread")
        axes.annotate(f"{ceiling / 1e9:.0f} Gflop/s", (1e3, ceiling / 1e9), ha="right", va="bottom", fontsize=8.5)
        axes.annotate(f"{bandwidth / 1e9:.1f} GB/s", (0.13, 0.13 * bandwidth / 1e9), rotation=0, va="bottom", fontsize=8.5)
        mine = [p for p in points if p[0]["precision"] == precision]
        look = styles(f"{p[0]['solver']}, {p[0]['deformation']}" for p in mine)
        for name, style in look.items():
            chosen = [p for p in mine if f"{p[0]['solver']}, {p[0]['deformation']}" == name]
            axes.plot([p[2] for p in chosen], [p[1] / 1e9 for p in chosen], label=name, **{**style, "linestyle": "none"})
        log_axis(axes, "x")
        log_axis(axes, "y")
        axes.set_xlabel("flop per byte, plain count")
        axes.set_ylabel("Gflop/s")
        legend(axes, ncols=2)
        made.append(Figure(f"Roofline, {precision}", to_svg(figure), command="firn bench roofline steps",
                           caption=f"{PLAIN_FLOP} flop per particle-step by the plain count. Points right of the bend are bound by arithmetic."))
    return made


def stages(results):
    made = []
    for case in sorted(results.suite("stages"), key=lambda c: c.name):
        rows = [(name.replace("_", " "), *np.maximum([q.median, *q.quartiles], 0)) for name, q in case.quantities.items() if name != "whole step" and q.units == "ns"]
        order = ["rasterize", "volumes", "grid forces", "grid velocities", "grid collisions", "integration", "deformation",
                 "particle velocities", "particle collisions", "positions"]
        rows.sort(key=lambda row: next((i for i, name in enumerate(order) if row[0].startswith(name)), 99))
        whole = case.quantities.get("whole step")
        if not case.quotable or whole is None:
            continue
        rows.append(("all stages", *[sum(r[i] for r in rows) for i in (1, 2, 3)]))
        rows.append(("whole step", whole.median, *whole.quartiles))
        made.append(Figure(f"{who(case)}, {case['deformation']}", bars(rows, "ns per particle"), command=case.command,
                           caption="“whole step”: the solver's fastest path, which may do several stages at once."))
    return made


def skips(results):
    cases = [c for c in results.suite("skips") if c.quotable]
    made = []
    for precision in ("float", "double"):
        mine = [c for c in cases if c["precision"] == precision]
        if not mine:
            continue
        rows = [(f"{c['skip']}: {c['situation']}", *with_quartiles(c, "saved", 100)) for c in sorted(mine, key=lambda c: (c["skip"], c["situation"]))]
        made.append(Figure(f"Saved by each skip, {precision}", bars(rows, "% of the step saved", zero=True, marks=[0]), command="firn bench skips"))
    return made


def snowball(results):
    """Bands over seeds: median and the range of all of them, never an order."""
    cases = [c for c in results.suite("snowball") if c.quotable]
    made = []
    for name in dict.fromkeys(key for c in cases for key in c.quantities):
        figure, axes = panel()
        for i, (solver, style) in enumerate(styles(who(c) for c in sorted(cases, key=who)).items()):
            line = sorted([c for c in cases if who(c) == solver], key=lambda c: c["resolution"])
            x = np.array([c["resolution"] for c in line]) + 0.12 * i
            values = [c.quantities[name].values for c in line]
            middle = np.array([np.median(v) for v in values])
            spread = [middle - [v.min() for v in values], [v.max() for v in values] - middle]
            axes.errorbar(x, middle, yerr=spread, label=solver, capsize=3, **style)
        quantity = cases[0].quantities[name]
        axes.set_xticks(sorted({c["resolution"] for c in cases}))
        axes.set_xlabel("spacings per radius of the ball")
        axes.set_ylabel(f"{name} [{quantity.units}]")
        legend(axes, ncols=2)
        made.append(Figure(quantity.meaning, to_svg(figure), command="firn bench snowball", caption="Median and range over five seeds."))
    return made


def targets(results):
    cases = [c for c in results.suite("targets") if c.quotable]
    rows = [(f"{c['target']}, {c['precision']}, {c['deformation']}", *with_quartiles(c, "time")) for c in sorted(cases, key=lambda c: (c["deformation"], c["precision"], c["target"]))]
    return [Figure("Time per particle and step", bars(rows, "ns"), command="firn bench targets")] if rows else []


def kernels(results):
    cases = [c for c in results.suite("kernels") if c.quotable]
    made = []
    for kernel in dict.fromkeys(c["kernel"] for c in cases):
        rows = [(f"{c['code']}, {c['precision']}", *with_quartiles(c, "time")) for c in sorted((c for c in cases if c["kernel"] == kernel), key=lambda c: c.value("time"))]
        made.append(Figure(str(kernel), bars(rows, "ns per item", log=max(r[1] for r in rows) > 20 * min(r[1] for r in rows)), command="firn bench kernels"))
    return made


def verification(results):
    made = []
    for subject, verdict in results.verify.items():
        worst = {}
        for row in verdict["rows"]:
            worst[row["topic"]] = max(worst.get(row["topic"], 1e-6), row["error"])
        figure, axes = panel(4.6, 0.9 + 0.26 * max(len(worst), 2))
        for y, value in enumerate(worst.values()):
            axes.plot([1e-6, value], [y, y], color=GOOD if value <= 1 else BAD, linewidth=5, solid_capstyle="butt")
        axes.axvline(1, color=BAD, linestyle="--", linewidth=1)
        axes.set_yticks(range(len(worst)), list(worst))
        axes.set_ylim(len(worst) - 0.5, -0.5)
        log_axis(axes, "x")
        axes.set_xlabel("largest error, in units of its bound", loc="right")
        axes.grid(False, axis="y")
        made.append(Figure(f"{subject}: {verdict['verdict']}", to_svg(figure), command=verdict["command"]))
    return made


def changes(changes):
    shown = [c for c in changes if c.kind in ("worse", "better")]
    shown = sorted(shown, key=lambda c: -abs(np.log(c.ratio)))[:14]
    if not shown:
        return []
    figure, axes = panel(4.6, 0.8 + 0.3 * len(shown))
    for y, c in enumerate(shown):
        value = 100 * (c.ratio - 1)
        axes.barh(y, value, height=0.6, color=BAD if c.kind == "worse" else GOOD)
        axes.plot([value - 100 * c.uncertainty, value + 100 * c.uncertainty], [y, y], color=INK, linewidth=1.2)
    axes.axvline(0, color=GRID)
    axes.set_yticks(range(len(shown)), [f"{c.case.suite} {c.case.name}"[:40] for c in shown])
    axes.set_ylim(len(shown) - 0.4, -0.6)
    axes.set_xlabel("% worse")
    axes.grid(False, axis="y")
    return [Figure("Largest changes", to_svg(figure), caption="Left of zero is better. Lines: ± three standard errors of the medians.")]


def noise(results):
    loops = [(c, c.calibration) for c in results.cases if len(c.calibration)]
    if not loops:
        return []
    figure, axes = panel()
    everything = np.concatenate([x for _, x in loops])
    typical = np.median(everything)
    axes.plot(np.repeat(np.arange(len(loops)), [len(x) for _, x in loops]), everything / typical, linestyle="none", marker=".", markersize=3)
    axes.axhline(1, color=MUTED, linewidth=1)
    axes.set_xlabel("case")
    axes.set_ylabel("fixed loop / its median")
    return [Figure("The fixed loop", to_svg(figure), caption=f"Median {plain(1e3 * typical)} ms.", command="firn bench")]
