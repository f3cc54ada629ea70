# SPDX-License-Identifier: BSD-3-Clause
"""The orthographic camera of the picture of the particles."""

import copy
from collections.abc import Sequence

import numpy as np

from .colliders import unit
from .kinds import Array, Json


class Camera:
    """Looks along the thinner horizontal direction, a little from above and from the side."""

    def __init__(self, scene: Json, clouds: Sequence[Array], width: int, height: int) -> None:
        up = -np.asarray(scene.get("gravity", [0, 0, -1]), float)
        self.up = unit(up) if np.linalg.norm(up) > 0 else np.array([0.0, 0.0, 1.0])
        low = np.min([c.min(axis=0) for c in clouds], axis=0)
        high = np.max([c.max(axis=0) for c in clouds], axis=0)
        # The widest direction across the gravity becomes the picture's horizontal.
        flat = (high - low) * (np.abs(self.up) < 0.7)
        side = np.zeros(3)
        side[int(np.argmax(flat))] = 1
        side = unit(side - self.up * (side @ self.up))
        away = np.cross(self.up, side)
        azimuth, elevation = np.radians(18), np.radians(13)
        look = np.cos(azimuth) * away - np.sin(azimuth) * side
        self.look = unit(np.cos(elevation) * look - np.sin(elevation) * self.up)
        self.right = unit(np.cross(self.look, self.up))
        self.screen_up = np.cross(self.right, self.look)
        corners = np.concatenate(clouds)
        u, v = corners @ self.right, corners @ self.screen_up
        margin = 1.16
        self.pixel = margin * max(np.ptp(u) / width, np.ptp(v) / height, 1e-9)  # [m]
        self.center = np.array(
            [(u.max() + u.min()) / 2, (v.max() + v.min()) / 2 - 0.02 * np.ptp(v)]
        )
        self.near = (corners @ self.look).min() - 10 * self.pixel * width
        self.middle = (corners @ self.look).mean() - self.near
        self.width, self.height = width, height

    def coarse(self, factor: int) -> "Camera":
        """The same view with `factor` times larger pixels."""
        other = copy.copy(self)
        other.width, other.height, other.pixel = (
            self.width // factor,
            self.height // factor,
            self.pixel * factor,
        )
        return other

    def project(self, x: Array) -> tuple[Array, Array, Array]:
        """Pixel coordinates (column, row) and depth [m] of points."""
        column = (x @ self.right - self.center[0]) / self.pixel + self.width / 2
        row = self.height / 2 - (x @ self.screen_up - self.center[1]) / self.pixel
        return column, row, x @ self.look - self.near

    def rays(self) -> Array:
        """Origin of the ray through each pixel, on the near plane: (height, width, 3)."""
        u = (np.arange(self.width) + 0.5 - self.width / 2) * self.pixel + self.center[0]
        v = (self.height / 2 - np.arange(self.height) - 0.5) * self.pixel + self.center[1]
        return (
            u[None, :, None] * self.right
            + v[:, None, None] * self.screen_up
            + self.near * self.look
        )
