# SPDX-License-Identifier: BSD-3-Clause
"""The slice of a stage that its pictures show."""

import numpy as np
from matplotlib import figure as mpl
from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from firn_reports.kinds import Array, Mask
from firn_reports.style import BAD, GRID, MUTED, SERIES, legend, panel

from .lesson import Lesson

BLUE, ORANGE, GREEN, PURPLE = SERIES[:4]


class View:
    """The slice of one stage."""

    def __init__(self, lesson: Lesson, stage: int) -> None:
        self.lesson, self.record = lesson, lesson.record_of(stage)
        self.scene, self.h = lesson.scene, lesson.scene.h
        self.before, self.after = self.record.at(stage - 1), self.record.at(stage)
        own = stage != 2  # the first step has other nodes
        x_p = self.record.at(0).x_p
        self.y = self.position(lesson.record.nodes[lesson.i])[1] if own else x_p[lesson.p, 1]
        self.layer = np.abs(self.position(self.record.nodes)[:, 1] - self.y) <= 0.51 * self.h
        self.slice = np.abs(x_p[:, 1] - self.y) <= self.h
        if own and not self.slice[lesson.p]:
            self.slice[lesson.p] = True
        self.x_i = self.position(self.record.nodes)
        self.own = own

    def position(self, nodes: ArrayLike) -> Array:
        """Positions (N, 3) [m] of nodes (N, 3)."""
        return self.scene.origin + self.h * np.asarray(nodes)

    def start(self, width: float = 5.2, height: float = 4.0) -> tuple[mpl.Figure, Axes]:
        """A new figure of the x–z plane."""
        figure, axes = panel(width, height)
        axes.set_aspect("equal")
        axes.set_xlabel("x [m]")
        axes.set_ylabel("z [m]")
        return figure, axes

    def frame(self, axes: Axes) -> None:
        """Limits, grid lines at the nodes, solid nodes, the chosen ones."""
        x, z = self.x_i[self.layer, 0], self.x_i[self.layer, 2]
        axes.set_xlim(x.min() - self.h, x.max() + self.h)
        axes.set_ylim(z.min() - self.h, z.max() + self.h)
        axes.grid(False)
        for value in np.unique(np.round(x / self.h)):
            axes.axvline(value * self.h, color=GRID, linewidth=0.5, zorder=0)
        for value in np.unique(np.round(z / self.h)):
            axes.axhline(value * self.h, color=GRID, linewidth=0.5, zorder=0)
        lesson = self.lesson
        x_p = self.record.at(0).x_p[lesson.p]
        axes.plot(
            x_p[0],
            x_p[2],
            "o",
            markersize=9,
            markerfacecolor="none",
            markeredgecolor=BAD,
            markeredgewidth=1.5,
            zorder=6,
            label=lesson.particle_name,
        )
        if self.own:
            solid = np.array(lesson.data["contacts"]["nodes_in_solid"], dtype=bool) & self.layer
            if solid.any():
                axes.plot(
                    self.x_i[solid, 0],
                    self.x_i[solid, 2],
                    "x",
                    color=MUTED,
                    markersize=4,
                    zorder=2,
                    label="inside a solid",
                )
            axes.plot(
                self.x_i[lesson.i, 0],
                self.x_i[lesson.i, 2],
                "s",
                markersize=9,
                markerfacecolor="none",
                markeredgecolor=BAD,
                markeredgewidth=1.5,
                zorder=6,
                label=lesson.node_name,
            )
        legend(axes, ncols=2)

    def particles(
        self,
        axes: Axes,
        values: Array | None = None,
        label: str = "",
        limits: tuple[float, float] | None = None,
        which: Mask | None = None,
        size: float = 9,
    ) -> None:
        """Particles as dots, coloured by `values` (one per particle) if there are any."""
        which = self.slice if which is None else which
        x = self.record.at(0).x_p[which]
        if values is None:
            axes.scatter(
                x[:, 0],
                x[:, 2],
                s=size * 0.5,
                color=BLUE,
                linewidths=0,
                zorder=3,
                rasterized=len(x) > 3000,
            )
            return
        low, high = limits or (values[which].min(), values[which].max())
        if high - low < 1e-12 * max(abs(low), abs(high), 1e-300):
            low, high = low - 0.5 * max(abs(low), 1e-3), high + 0.5 * max(abs(high), 1e-3)
        dots = axes.scatter(
            x[:, 0],
            x[:, 2],
            s=size,
            c=values[which],
            cmap="viridis",
            vmin=low,
            vmax=high,
            linewidths=0,
            zorder=3,
            rasterized=len(x) > 3000,
        )
        bar = axes.figure.colorbar(dots, ax=axes, shrink=0.8, aspect=30, pad=0.02)
        bar.set_label(label)
        bar.outline.set_linewidth(0.5)

    def arrows(
        self,
        axes: Axes,
        at: Array,
        vectors: Array,
        color: str,
        label: str = "",
        scale: float | None = None,
        width: float = 0.004,
    ) -> float:
        """Arrows in the x–z plane; returns their scale.

        The longest is 1.5 cells long unless `scale` says else.
        """
        longest = np.max(np.hypot(vectors[:, 0], vectors[:, 2]), initial=0)
        scale = scale or (longest / (1.5 * self.h) if longest > 0 else 1)
        axes.quiver(
            at[:, 0],
            at[:, 2],
            vectors[:, 0],
            vectors[:, 2],
            color=color,
            angles="xy",
            scale_units="xy",
            scale=scale,
            width=width,
            zorder=5,
            label=label or None,
        )
        return scale

    def longest(self, vectors: Array, unit: str) -> str:
        """Length of the longest of the vectors (N, 3), with its unit."""
        return f"{np.max(np.linalg.norm(vectors, axis=1), initial=0):.3g} {unit}"
