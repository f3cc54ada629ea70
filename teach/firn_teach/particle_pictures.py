# SPDX-License-Identifier: BSD-3-Clause
"""What happens to the particles: pictures of stages 7 to 10."""

import numpy as np

from firn_reports.kinds import Array
from firn_reports.page import Figure
from firn_reports.style import BAD, INK, legend, panel, to_svg

from .by_hand import weights
from .view import BLUE, ORANGE, View


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
