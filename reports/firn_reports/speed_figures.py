# SPDX-License-Identifier: BSD-3-Clause
"""How fast steps are: rates, threads, stages, skips."""

import numpy as np

from .drawing import bars, left_out, styles, who, with_quartiles
from .page import Figure
from .results import Case, Results
from .style import legend, log_axis, panel, plain, to_svg


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
