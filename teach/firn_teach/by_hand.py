# SPDX-License-Identifier: BSD-3-Clause
"""Every stage once more, for one particle or one node, in a few lines of NumPy.

Written from the equations, not from the reference: the pages show this code beside
what it computes from the lesson's own numbers and what the reference computed.
"""

import inspect
from types import SimpleNamespace

import numpy as np

from firn_reports.kinds import Array

from . import STAGES
from .lesson import Lesson


def N(x):
    d = np.abs(x)
    return np.where(d < 1, d**3 / 2 - d**2 + 2 / 3, np.where(d < 2, (2 - d) ** 3 / 6, 0))


def dN(x):
    d = np.abs(x)
    return np.sign(x) * np.where(d < 1, 1.5 * d**2 - 2 * d, np.where(d < 2, -((2 - d) ** 2) / 2, 0))


def weights(scene, x, nodes):
    """w_ip and its gradient with respect to x_p, for all pairs of rows of x and nodes."""
    X = (x - scene.origin) / scene.h - nodes
    n = scene.period_nodes
    X = np.where(n > 0, X - n * np.round(X / np.maximum(n, 1)), X)  # the nearest image
    a, b, c = np.moveaxis(X, -1, 0)
    w = N(a) * N(b) * N(c)
    grad_w = np.stack([dN(a) * N(b) * N(c), N(a) * dN(b) * N(c), N(a) * N(b) * dN(c)], -1) / scene.h
    return w, grad_w


def collide(contacts, v):
    for c in contacts:
        if c["phi"] > 0:
            continue
        n, v_co, mu = np.array(c["normal"]), np.array(c["velocity"]), c["friction"]
        v_n = (v - v_co) @ n
        v_t = (v - v_co) - n * v_n
        if c["sticky"] or (v_n < 0 and np.linalg.norm(v_t) <= -mu * v_n):
            v = v_co
        elif v_n < 0:
            v = (1 + mu * v_n / np.linalg.norm(v_t)) * v_t + v_co
    return v


def rasterize(scene, s, p, i, lesson):
    w, _ = weights(scene, s.x_p, lesson.record.nodes[i])
    m_i = np.sum(s.m_p * w)
    v_i = (s.m_p * w) @ s.v_p / m_i
    return {"m_i": m_i, "v_i": v_i}


def volumes(scene, s, p, i, lesson):
    if s.V_p0[p] > 0:  # stated by the scene
        return {"V_p0": s.V_p0[p]}
    w, _ = weights(scene, s.x_p[p], lesson.first.nodes)
    rho_p0 = np.sum(s.m_i * w) / scene.h**3
    return {"V_p0": s.m_p[p] / rho_p0}


def grid_forces(scene, s, p, i, lesson):
    material = lesson.material()
    harder = np.exp(material.hardening * (1 - np.linalg.det(s.F_P)))
    mu, lam = material.mu_0 * harder, material.lambda_0 * harder
    U, _, Vt = np.linalg.svd(s.F_E)
    R = U @ Vt  # det F_E > 0 here: R is a rotation
    J, Ft = np.linalg.det(s.F_E), np.swapaxes(s.F_E, 1, 2)
    tau = 2 * mu[:, None, None] * (s.F_E - R) @ Ft + (lam * (J - 1) * J)[:, None, None] * np.eye(3)
    _, grad_w = weights(scene, s.x_p, lesson.record.nodes[i])
    return {"f_i": -np.einsum("p,prc,pc->r", s.V_p0, tau, grad_w)}


def grid_velocities(scene, s, p, i, lesson):
    return {"v_i_star": s.v_i[i] + lesson.record.dt * (s.f_i[i] / s.m_i[i] + scene.gravity)}


def grid_collisions(scene, s, p, i, lesson):
    return {"v_i_star": collide(lesson.data["contacts"]["node"], s.v_i_star[i])}


def integration(scene, s, p, i, lesson):
    return {"v_i_new": s.v_i_star[i]}  # explicit; the semi-implicit solve has its own page


def deformation(scene, s, p, i, lesson):
    _, grad_w = weights(scene, s.x_p[p], lesson.record.nodes)
    grad_v = np.einsum("ir,ic->rc", s.v_i_new, grad_w)
    F_hat = (np.eye(3) + lesson.record.dt * grad_v) @ s.F_E[p]
    material = lesson.material()
    low, high = 1 - material.critical_compression[p], 1 + material.critical_stretch[p]
    U, sigma, Vt = np.linalg.svd(F_hat)
    sigma = np.clip(sigma, low, high)
    return {
        "F_E": U @ np.diag(sigma) @ Vt,
        "F_P": Vt.T @ np.diag(1 / sigma) @ U.T @ F_hat @ s.F_P[p],
    }


def particle_velocities(scene, s, p, i, lesson):
    w, _ = weights(scene, s.x_p[p], lesson.record.nodes)
    v_PIC = w @ s.v_i_new
    v_FLIP = s.v_p[p] + w @ (s.v_i_new - s.v_i)
    return {"v_p": (1 - scene.alpha) * v_PIC + scene.alpha * v_FLIP}


def particle_collisions(scene, s, p, i, lesson):
    return {"v_p": collide(lesson.data["contacts"]["particle"], s.v_p[p])}


def positions(scene, s, p, i, lesson):
    x = s.x_p[p] + lesson.record.dt * s.v_p[p]
    period = scene.period_nodes * scene.h
    wrapped = scene.origin + (x - scene.origin) % np.where(period > 0, period, 1)
    return {"x_p": np.where(period > 0, wrapped, x)}


def code(stage: int) -> str:
    """Source of the function for a stage."""
    return inspect.getsource(globals()[STAGES[stage - 1]])


def helpers() -> str:
    """Source of the functions that several stages call."""
    return "\n\n".join(inspect.getsource(f).rstrip() for f in (N, dN, weights, collide)) + "\n"


def size(lesson: Lesson, stage: int, s: SimpleNamespace, reference: Array) -> float:
    """The largest number that enters a result: what its rounding errors are small against."""
    largest = np.max(np.abs(reference))
    if stage == 3:  # F_E − R_E cancels: what is left may be as small as the rounding of F_E itself
        material = lesson.material()
        mu = material.mu_0 * np.exp(material.hardening * (1 - np.linalg.det(s.F_P)))
        _, grad_w = weights(lesson.scene, s.x_p, lesson.record.nodes[lesson.i])
        largest = max(largest, np.max(2 * mu * s.V_p0 * np.linalg.norm(grad_w, axis=1)))
    return largest if largest > 0 else 1


def run(lesson: Lesson, stage: int) -> list[tuple[str, Array, Array, float]]:
    """Rows (field, NumPy's value, the reference's value, largest difference over size())."""
    if stage == 6 and lesson.scene.semi_implicit:
        return []
    record = lesson.record_of(stage)
    results = globals()[STAGES[stage - 1]](
        lesson.scene, record.at(stage - 1), lesson.p, lesson.i, lesson
    )
    after = record.at(stage)
    rows = []
    for field, value in results.items():
        reference = getattr(after, field)[
            lesson.p if field in ("V_p0", "F_E", "F_P", "v_p", "x_p") else lesson.i
        ]
        difference = np.max(np.abs(value - reference)) / size(
            lesson, stage, record.at(stage - 1), reference
        )
        rows.append((field, np.asarray(value), np.asarray(reference), difference))
    return rows
