# SPDX-License-Identifier: BSD-3-Clause
"""What happens on the grid: pictures of stages 1 to 6."""

import numpy as np

from firn_reports.kinds import Json
from firn_reports.page import Figure
from firn_reports.style import BAD, MUTED, legend, log_axis, panel, to_svg

from .by_hand import N, dN
from .lesson import Lesson
from .view import BLUE, ORANGE, View


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
