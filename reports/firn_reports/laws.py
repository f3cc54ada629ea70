# SPDX-License-Identifier: BSD-3-Clause
"""The laws that momentum and centre of mass obey in free flight."""

import numpy as np

from .colliders import free_flight_reach
from .trajectory import Frame, Trajectory


class Laws:
    """What momentum and centre of mass must be while no collider is in reach.

    p(t) = p0 + M g t, and X_n = X_{n-1} + Δt_n V_n with V_n = V_0 + g t_n: the
    explicit step adds gravity before it moves (Stomakhin et al. 2013, steps 4
    and 10). Both hold for any internal state and any FLIP fraction.
    """

    def __init__(self, trajectory: Trajectory, first: Frame) -> None:
        d = trajectory.diagnostics
        g = np.asarray(trajectory.scene.get("gravity", [0, 0, 0]), float)
        mass = first.m.sum()
        p0 = (first.m[:, None] * first.v).sum(axis=0)
        X0 = (first.m[:, None] * first.x).sum(axis=0) / mass
        elapsed = d["time"] - first.time
        self.momentum = p0 + mass * g * elapsed[:, None]
        self.center = X0 + np.cumsum(d["dt"][:, None] * (p0 / mass + g * elapsed[:, None]), axis=0)
        scale_p = np.maximum(
            np.linalg.norm(self.momentum, axis=1),
            mass * max(np.linalg.norm(first.v, axis=1).max(), 1e-300),
        )
        self.momentum_error = np.linalg.norm(d["momentum"] - self.momentum, axis=1) / np.maximum(
            scale_p, 1e-300
        )
        scale_x = max(np.linalg.norm(X0), np.ptp(first.x, axis=0).max(), 1e-300)
        self.center_error = np.linalg.norm(d["center_of_mass"] - self.center, axis=1) / scale_x
        reach = free_flight_reach(trajectory.scene, first.x)
        periodic = np.any(trajectory.scene.get("grid", {}).get("periodic", [0]))
        self.known = reach is not None and not periodic
        # A rigid estimate: the farthest particle moves as the centre of mass plus its own speed.
        spread = np.linalg.norm(first.v - p0 / mass, axis=1).max() * elapsed
        travelled = np.linalg.norm(self.center - X0, axis=1) + spread
        self.free = np.zeros(len(elapsed), bool)
        if reach is not None and not periodic:
            self.free = travelled < reach
