# SPDX-License-Identifier: BSD-3-Clause
"""What the figures of several suites are drawn with: labels, line styles, horizontal bars."""

from collections.abc import Callable, Iterable, Sequence
from typing import Any, TypeAlias

from .results import Case
from .style import BAD, DASHES, INK, MARKERS, MUTED, SERIES, log_axis, panel, plain, to_svg

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
