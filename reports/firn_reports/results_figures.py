# SPDX-License-Identifier: BSD-3-Clause
"""The figures of a results page, small panels that say one thing each."""

from collections.abc import Sequence

import numpy as np

from .baseline import Change
from .drawing import styles, who
from .page import Figure
from .results import Results
from .style import BAD, GOOD, GRID, INK, MUTED, SERIES, legend, log_axis, panel, plain, to_svg


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
