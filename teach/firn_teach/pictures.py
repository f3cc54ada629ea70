"""What each stage looks like on the lesson's own scene, seen along y.

Nodes are shown in the layer of the chosen node, particles within one cell of that layer;
a ring marks the chosen particle, a square the chosen node.
"""

import numpy as np
from matplotlib import figure as mpl
from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from firn_reports.kinds import Array, Json, Mask
from firn_reports.page import Figure
from firn_reports.style import BAD, GRID, INK, MUTED, SERIES, legend, log_axis, panel, to_svg

from .by_hand import N, dN, weights
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


def kernel(lesson: Lesson) -> Figure:
    """N and its derivative, with the chosen particle's four weights along x."""
    figure, axes = panel(4.6, 2.9)
    x = np.linspace(-2.2, 2.2, 400)
    axes.plot(x, N(x), color=BLUE, label="N")
    axes.plot(x, dN(x), "--", color=ORANGE, label="N′")
    X = (lesson.record.at(0).x_p[lesson.p, 0] - lesson.scene.origin[0]) / lesson.scene.h
    d = X - (np.floor(X) - 1 + np.arange(4))
    axes.plot(d, N(d), "o", color=BAD, label=f"{lesson.particle_name}, its four nodes along x")
    axes.set_xlabel("(x_p − x_i) / h")
    legend(axes)
    return Figure(
        "The kernel",
        to_svg(figure),
        caption=f"The cubic B-spline and its derivative. The four weights marked sum to {N(d).sum():.15g}.",
    )


def rasterize(v: View) -> list[Figure]:
    """Stage 1: velocities of particles, masses and velocities of nodes."""
    figure, axes = v.start()
    v.particles(axes)
    v.arrows(axes, v.before.x_p[v.slice], v.before.v_p[v.slice], BLUE, width=0.0025)
    v.frame(axes)
    first = Figure(
        "Before: particles",
        to_svg(figure),
        caption=f"Velocities of the particles; the longest is {v.longest(v.before.v_p[v.slice], 'm/s')}.",
    )
    figure, axes = v.start()
    m = v.after.m_i[v.layer]
    axes.scatter(
        v.x_i[v.layer, 0],
        v.x_i[v.layer, 2],
        s=120 * m / m.max(),
        color=ORANGE,
        alpha=0.55,
        linewidths=0,
        zorder=2,
    )
    v.arrows(axes, v.x_i[v.layer], v.after.v_i[v.layer], BLUE)
    v.frame(axes)
    return [
        first,
        Figure(
            "After: nodes",
            to_svg(figure),
            caption=f"Area of a disk: mass of the node, at most {m.max():.3g} kg, at least {m.min():.3g} kg. Arrows: velocity. "
            "The lightest nodes have velocities like all others.",
        ),
        kernel(v.lesson),
    ]


def volumes(v: View) -> list[Figure]:
    """Stage 2: the density that particles see."""
    density = v.after.m_p / v.after.V_p0
    figure, axes = v.start()
    v.particles(axes, density, "density ρ [kg/m³]")
    v.frame(axes)
    one = Figure(
        "Density that the particles see",
        to_svg(figure),
        caption="In the first step. Near the surface part of the kernel is empty, so the estimated density is too low.",
    )
    figure, axes = panel(4.6, 2.9)
    axes.hist(density, bins=40, color=BLUE)
    for material in v.scene.materials:
        axes.axvline(
            material["density"],
            color=BAD,
            linestyle="--",
            label=f"{material['name']}, as the scene states it",
        )
    axes.set_xlabel("density [kg/m³]")
    axes.set_ylabel("particles")
    legend(axes)
    total, stated = (
        v.after.V_p0.sum(),
        sum(v.after.m_p / np.array([m["density"] for m in v.scene.materials])[v.record.material]),
    )
    return [
        one,
        Figure(
            "Estimated densities",
            to_svg(figure),
            caption=f"All particles together take {total:.4g} m³; mass over stated density is {stated:.4g} m³.",
        ),
    ]


def grid_forces(v: View) -> list[Figure]:
    """Stage 3: elastic volume and forces, hardening."""
    figure, axes = v.start()
    v.particles(axes, np.linalg.det(v.before.F_E), "J_E = det F_E")
    v.arrows(axes, v.x_i[v.layer], v.after.f_i[v.layer], ORANGE)
    v.frame(axes)
    total, size = np.linalg.norm(v.after.f_i.sum(0)), np.linalg.norm(v.after.f_i, axis=1).sum()
    one = Figure(
        "Elastic volume and forces",
        to_svg(figure),
        caption=f"The longest arrow is {v.longest(v.after.f_i[v.layer], 'N')}. All forces of the scene sum to {total:.2g} N; "
        f"their sizes sum to {size:.3g} N.",
    )
    figure, axes = v.start()
    J_P = np.linalg.det(v.before.F_P)
    v.particles(axes, np.exp(v.lesson.material().hardening * (1 - J_P)), "hardening e^(ξ(1 − J_P))")
    v.frame(axes)
    return [
        one,
        Figure(
            "Hardening",
            to_svg(figure),
            caption=f"The factor on μ and λ. J_P lies between {J_P.min():.4g} and {J_P.max():.4g}.",
        ),
    ]


def grid_velocities(v: View) -> list[Figure]:
    """Stage 4: velocities before and after, and their change."""
    figure, axes = v.start()
    scale = v.arrows(axes, v.x_i[v.layer], v.before.v_i[v.layer], MUTED, "v_i")
    v.arrows(
        axes, v.x_i[v.layer], v.after.v_i_star[v.layer], BLUE, "v_i*", scale=scale, width=0.003
    )
    v.frame(axes)
    change = v.after.v_i_star - v.before.v_i
    one = Figure("Velocity before and after", to_svg(figure), caption="Grey: v_i. Blue: v_i*.")
    figure, axes = v.start()
    v.arrows(axes, v.x_i[v.layer], change[v.layer], ORANGE)
    v.frame(axes)
    return [
        one,
        Figure(
            "What the forces changed",
            to_svg(figure),
            caption=f"v_i* − v_i, the longest {v.longest(change[v.layer], 'm/s')}. Gravity's share is {np.linalg.norm(v.scene.gravity) * v.record.dt:.3g} m/s everywhere.",
        ),
    ]


def grid_collisions(v: View) -> list[Figure]:
    """Stage 5: velocities of nodes in contact."""
    figure, axes = v.start()
    changed = np.any(v.after.v_i_star != v.before.v_i_star, axis=1)
    scale = v.arrows(axes, v.x_i[v.layer], v.before.v_i_star[v.layer], MUTED)
    v.arrows(axes, v.x_i[v.layer], v.after.v_i_star[v.layer], BLUE, scale=scale, width=0.003)
    here = v.layer & changed
    axes.plot(
        v.x_i[here, 0],
        v.x_i[here, 2],
        "o",
        color=ORANGE,
        markersize=5,
        zorder=4,
        label="velocity changed",
    )
    v.frame(axes)
    sticks = int(np.sum(changed & ~np.any(v.after.v_i_star, axis=1)))
    impulse = (v.before.m_i[:, None] * (v.after.v_i_star - v.before.v_i_star)).sum(0)
    return [
        Figure(
            "Before and after contact",
            to_svg(figure),
            caption=f"Grey: v_i* before; blue: after. {int(changed.sum())} nodes of the scene are in contact, {sticks} of them came to rest. "
            f"Momentum taken up from the solids: ({impulse[0]:.3g}, {impulse[1]:.3g}, {impulse[2]:.3g}) kg m/s.",
            wide=False,
        )
    ]


def integration(v: View) -> list[Figure]:
    """Stage 6: velocities at the end of the step."""
    figure, axes = v.start()
    v.arrows(axes, v.x_i[v.layer], v.after.v_i_new[v.layer], BLUE)
    v.frame(axes)
    change = np.linalg.norm(v.after.v_i_new - v.before.v_i_star, axis=1).max()
    return [
        Figure(
            "The velocity at the end of the step",
            to_svg(figure),
            caption=f"Largest difference to v_i*: {change:.3g} m/s.",
        ),
        implicit_energy(v.lesson),
    ]


def implicit_energy(lesson: Lesson) -> Figure:
    """Energy after the same time, for longer and longer steps."""
    trials = lesson.data["implicit_trials"]

    def energy(t: Json, which: str) -> float:
        """Kinetic and elastic energy [J] at the end, infinite if the run failed."""
        if t[f"{which}_error"]:
            return np.inf
        values = [float(t[which][k]) for k in ("kinetic_energy", "elastic_energy")]
        return sum(values)

    figure, axes = panel(4.6, 3.1)
    multiples = np.array([t["multiple"] for t in trials])
    for which, color, mark in (("explicit", ORANGE, "s--"), ("semi_implicit", BLUE, "o-")):
        values = np.array([energy(t, which) for t in trials])
        finite = np.isfinite(values)
        axes.plot(
            multiples[finite], values[finite], mark, color=color, label=which.replace("_", "-")
        )
    start = lesson.data["diagnostics"]["before"]
    axes.axhline(
        start["kinetic_energy"] + start["elastic_energy"],
        color=MUTED,
        linewidth=1,
        linestyle=":",
        label="at the beginning",
    )
    log_axis(axes, "y")
    log_axis(axes, "x")
    axes.set_xlabel(f"Δt, in units of {lesson.record.dt:.3g} s")
    axes.set_ylabel("kinetic + elastic energy [J]")
    legend(axes)
    span = trials[0]["steps"]
    return Figure(
        "How long a step each method can take",
        to_svg(figure),
        caption=f"The energy after the time of {span} step{'s' if span > 1 else ''} of this scene, reached with longer steps. Where a point is missing, the run failed.",
    )


def F_hat(v: View) -> Array:
    """F̂_E of every particle, by the formulas of by_hand."""
    result = np.empty_like(v.before.F_E)
    for p in range(len(result)):
        near = np.all(np.abs(nearest(v, p)) < 2, axis=1)
        _, grad_w = weights(v.scene, v.before.x_p[p], v.record.nodes[near])
        result[p] = (
            np.eye(3) + v.record.dt * np.einsum("ir,ic->rc", v.before.v_i_new[near], grad_w)
        ) @ v.before.F_E[p]
    return result


def nearest(v: View, p: int) -> Array:
    """(x_p − x_i) / h to the nearest image of each node, (nodes, 3)."""
    X = (v.before.x_p[p] - v.scene.origin) / v.h - v.record.nodes
    n = v.scene.period_nodes
    return np.where(n > 0, X - n * np.round(X / np.maximum(n, 1)), X)


def deformation(v: View) -> list[Figure]:
    """Stage 7: singular values before and after the clamp, plastic flow."""
    before, after = (
        np.linalg.svd(F_hat(v), compute_uv=False),
        np.linalg.svd(v.after.F_E, compute_uv=False),
    )
    yields = np.any(v.after.F_P != v.before.F_P, axis=(1, 2))
    figure, axes = panel(4.6, 4.0)
    axes.plot(
        before[yields, 2],
        before[yields, 0],
        "o",
        markerfacecolor="none",
        color=ORANGE,
        markersize=4,
        markeredgewidth=0.7,
        label=f"before the clamp ({int(yields.sum())} yield)",
    )
    axes.plot(after[:, 2], after[:, 0], ".", color=BLUE, markersize=3, label="after")
    chosen = v.lesson.p
    axes.plot(
        before[chosen, 2],
        before[chosen, 0],
        "o",
        markersize=9,
        markerfacecolor="none",
        markeredgecolor=BAD,
        markeredgewidth=1.5,
        label=v.lesson.particle_name,
    )
    for material in v.scene.materials:
        low, high = (
            1 - float(material["critical_compression"]),
            1 + float(material["critical_stretch"]),
        )
        if np.isfinite(low + high):
            axes.plot(
                [low, low, high, high, low],
                [low, high, high, low, low],
                color=INK,
                linewidth=0.9,
                label=f"limits of {material['name']}",
            )
    # The box reaches far below, where no particle can be: the smallest value is not above the
    # largest.
    values = np.concatenate([before[:, 0], after[:, 0]])
    margin = 0.15 * (values.max() - values.min()) + 1e-6
    axes.set_ylim(values.min() - margin, values.max() + margin)
    axes.set_xlabel("smallest singular value")
    axes.set_ylabel("largest singular value")
    legend(axes, ncols=2)
    one = Figure(
        "Singular values of F_E",
        to_svg(figure),
        caption="Each particle at its smallest and largest stretch. Rings: F̂_E. Dots: F_E after the return mapping.",
    )
    figure, axes = v.start()
    v.particles(axes, np.linalg.det(v.after.F_P), "J_P = det F_P")
    x = v.before.x_p[yields & v.slice]
    axes.plot(
        x[:, 0],
        x[:, 2],
        "o",
        markerfacecolor="none",
        color=ORANGE,
        markersize=4.5,
        markeredgewidth=0.7,
        zorder=4,
        label="yields in this step",
    )
    v.frame(axes)
    return [
        one,
        Figure(
            "Plastic flow",
            to_svg(figure),
            caption="Below 1 the snow is permanently compressed, above 1 it is torn.",
        ),
    ]


def particle_velocities(v: View) -> list[Figure]:
    """Stage 8: new velocities, and what PIC would smooth away."""
    figure, axes = v.start()
    x = v.before.x_p[v.slice]
    v.particles(axes)
    v.arrows(axes, x, v.after.v_p[v.slice], BLUE, width=0.0025)
    v.frame(axes)
    one = Figure(
        "The new velocities",
        to_svg(figure),
        caption=f"The longest is {v.longest(v.after.v_p[v.slice], 'm/s')}.",
    )
    pic, flip, m = np.empty_like(v.before.v_p), np.empty_like(v.before.v_p), v.before.m_p[:, None]
    for p in range(len(pic)):
        near = np.all(np.abs(nearest(v, p)) < 2, axis=1)
        w, _ = weights(v.scene, v.before.x_p[p], v.record.nodes[near])
        pic[p] = w @ v.before.v_i_new[near]
        flip[p] = v.before.v_p[p] + w @ (v.before.v_i_new[near] - v.before.v_i[near])
    figure, axes = v.start()
    v.particles(axes)
    v.arrows(axes, x, (flip - pic)[v.slice], ORANGE, width=0.0025)
    v.frame(axes)
    energies = [0.5 * np.sum(m * u**2) for u in (pic, v.after.v_p, flip)]
    return [
        one,
        Figure(
            "What PIC would have smoothed away",
            to_svg(figure),
            caption=f"v_FLIP − v_PIC, the longest {v.longest((flip - pic)[v.slice], 'm/s')}. Kinetic energy: PIC {energies[0]:.5g} J, "
            f"α = {v.scene.alpha:g} {energies[1]:.5g} J, FLIP {energies[2]:.5g} J.",
        ),
    ]


def particle_collisions(v: View) -> list[Figure]:
    """Stage 9: particles that met a solid."""
    figure, axes = v.start()
    v.particles(axes)
    change = v.after.v_p - v.before.v_p
    hit = np.any(change != 0, axis=1)
    if hit.any():
        v.arrows(axes, v.before.x_p[hit], change[hit], ORANGE)
    v.frame(axes)
    return [
        Figure(
            "Particles that met a solid",
            to_svg(figure),
            caption=f"{int(hit.sum())} particles were inside a solid and moving in. Arrows: the change of their velocity.",
        )
    ]


def positions(v: View) -> list[Figure]:
    """Stage 10: displacements."""
    figure, axes = v.start()
    moved = v.after.x_p - v.before.x_p
    v.particles(axes)
    longest = np.max(np.linalg.norm(moved, axis=1), initial=0)
    v.arrows(axes, v.before.x_p[v.slice], moved[v.slice], BLUE, width=0.0025)
    v.frame(axes)
    return [
        Figure(
            "The displacement",
            to_svg(figure),
            caption=f"Enlarged. The longest is {longest:.3g} m, {longest / v.h:.3g} of a cell.",
        )
    ]


def of_stage(lesson: Lesson, stage: int, name: str) -> list[Figure]:
    """The figures of a stage."""
    return globals()[name](View(lesson, stage))
