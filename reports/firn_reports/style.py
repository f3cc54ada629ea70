# SPDX-License-Identifier: BSD-3-Clause
"""One look for every figure: small panels, thin lines, colours that follow the page's theme."""

import io
import itertools
import re
from typing import Any

import matplotlib
from cycler import cycler

matplotlib.use("svg")
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

# Every colour that a figure may use. The SVG text gets `var(--name, #hex)` in
# place of the hex value, so the page's light and dark themes recolour it.
INK, GRID, MUTED = "#1d2733", "#dfe4ea", "#66727f"
SERIES = ["#1f6fc4", "#c8500f", "#1b8a5a", "#8a4bb8", "#b8860b", "#c2276b", "#3f8f9f", "#6b6f76"]
GOOD, BAD = "#1a7f45", "#c0262d"
CSS_NAMES = {INK: "ink", GRID: "grid", MUTED: "muted", GOOD: "good", BAD: "bad"}
CSS_NAMES |= {colour: f"s{i + 1}" for i, colour in enumerate(SERIES)}
# A second mark beside the colour, for those who print or do not tell colours apart.
DASHES = ["-", "--", "-.", ":", (0, (5, 1, 1, 1, 1, 1)), (0, (1, 1)), (0, (8, 2)), (0, (3, 3))]
MARKERS = ["o", "s", "^", "D", "v", "P", "X", "*"]

matplotlib.rcParams.update(
    {
        "svg.fonttype": "none",
        "svg.hashsalt": "firn",
        "font.size": 9.5,
        "font.family": "DejaVu Sans",
        "text.color": INK,
        "axes.labelcolor": INK,
        "xtick.color": MUTED,
        "ytick.color": MUTED,
        "xtick.labelcolor": INK,
        "ytick.labelcolor": INK,
        "axes.edgecolor": MUTED,
        "axes.linewidth": 0.8,
        "axes.spines.top": False,
        "axes.spines.right": False,
        "axes.grid": True,
        "grid.color": GRID,
        "grid.linewidth": 0.7,
        "axes.axisbelow": True,
        "axes.titlesize": 9.5,
        "axes.titlelocation": "left",
        "lines.linewidth": 1.6,
        "legend.frameon": False,
        "legend.fontsize": 8.5,
        "lines.markersize": 4.5,
        "axes.prop_cycle": cycler(color=SERIES),
        "figure.constrained_layout.use": True,
        "axes.formatter.useoffset": False,
        "axes.formatter.limits": (-3, 4),
        "axes.formatter.use_mathtext": False,
    }
)


def panel(width: float = 4.6, height: float = 3.1) -> tuple[Figure, Axes]:
    """A new figure with one axes; a page sets panels side by side and lets them wrap."""
    figure, axes = plt.subplots(figsize=(width, height))
    figure.patch.set_alpha(0)
    axes.patch.set_alpha(0)
    return figure, axes


def log_axis(axes: Axes, which: str, base: float = 10) -> None:
    """A logarithmic axis with plain-text tick labels (1e-3, not a formula)."""
    getattr(axes, f"set_{which}scale")("log", base=base)
    axis = getattr(axes, f"{which}axis")
    if base == 10:
        axis.set_major_locator(LogLocator(base=10, numticks=7))
    axis.set_major_formatter(FuncFormatter(lambda value, _: plain(value)))
    axis.set_minor_formatter(NullFormatter())
    low, high = sorted(axis.get_data_interval())
    if base == 10 and low > 0 and high / low < 30:
        # Less than a decade and a half: a label at 1, 2 and 5 of each.
        axis.set_major_locator(LogLocator(base=10, subs=(1, 2, 5), numticks=12))


def plain(value: float) -> str:
    """Short decimal text: 1000, 0.01, 1e-9."""
    if value == 0 or 1e-3 <= abs(value) < 1e5:
        return f"{value:.{5 if abs(value) >= 1e4 else 4}g}"
    return re.sub(r"e([+-])0*(\d)", lambda m: "e" + m[1].replace("+", "") + m[2], f"{value:.3g}")


def legend(axes: Axes, **options: Any) -> None:
    """Legend above the axes, where it covers no data."""
    handles, labels = axes.get_legend_handles_labels()
    if handles:
        # A label of n characters takes about 0.065 n inches, the handle beside it 0.45.
        figure = axes.figure
        assert isinstance(figure, Figure)
        room = figure.get_figwidth() / (0.45 + 0.065 * max(len(label) for label in labels))
        columns = max(1, min(options.pop("ncols", 3), len(labels), int(room)))
        axes.legend(
            handles,
            labels,
            loc="lower left",
            bbox_to_anchor=(0, 1.0),
            ncols=columns,
            borderaxespad=0.1,
            columnspacing=1.2,
            handlelength=1.8,
            **options,
        )


# Tells the ids of the figures of one page apart.
_serials = itertools.count(1)


def to_svg(figure: Figure) -> str:
    """The figure as an <svg> element for the page; closes the figure."""
    buffer = io.StringIO()
    figure.savefig(buffer, format="svg", metadata={"Date": None, "Creator": None})
    plt.close(figure)
    return inline_svg(buffer.getvalue(), f"f{next(_serials)}-")


def inline_svg(text: str, prefix: str) -> str:
    """Strips the XML prologue, makes ids unique on the page, and hands colours to CSS."""
    svg = text[text.index("<svg") :]
    svg = re.sub(r"<metadata>.*?</metadata>", "", svg, flags=re.DOTALL)
    svg = re.sub(r'\bid="([^"]+)"', lambda m: f'id="{prefix}{m[1]}"', svg)
    svg = re.sub(r"url\(#([^)]+)\)", lambda m: f"url(#{prefix}{m[1]})", svg)
    svg = re.sub(r'xlink:href="#([^"]+)"', lambda m: f'href="#{prefix}{m[1]}"', svg)
    for colour, name in CSS_NAMES.items():
        svg = svg.replace(f": {colour}", f": var(--{name}, {colour})")
    svg = svg.replace("'DejaVu Sans'", "inherit").replace("inherit, ", "")
    svg = re.sub(r'<svg ([^>]*?)width="[\d.]+pt" ?', r"<svg \1", svg, count=1)
    return re.sub(r'<svg ([^>]*?)height="[\d.]+pt" ?', r"<svg \1", svg, count=1)
