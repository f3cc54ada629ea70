# SPDX-License-Identifier: BSD-3-Clause
"""Where the rays of the camera meet the colliders: sphere tracing through signed distances."""

import numpy as np

from .camera import Camera
from .colliders import collider_distance, unit
from .kinds import Array, Json


def trace_colliders(camera: Camera, scene: Json, t: float) -> tuple[Array, Array, Array]:
    """Depth [m], normal and point of the first collider surface behind each pixel."""
    shown = [c for c in scene.get("collider", []) if _visible(c, camera)]
    origin = camera.rays()
    depth = np.full(origin.shape[:2], np.inf)
    normal = np.zeros_like(origin)
    for collider in shown:
        d = _trace(collider, origin, camera, t)
        nearer = d < depth
        depth = np.where(nearer, d, depth)
        point = origin[nearer] + d[nearer][:, None] * camera.look
        e = 0.5 * camera.pixel
        n = np.stack(
            [
                _phi(collider, point + e * axis, t) - _phi(collider, point - e * axis, t)
                for axis in np.eye(3)
            ],
            axis=-1,
        )
        normal[nearer] = n / np.maximum(np.linalg.norm(n, axis=-1, keepdims=True), 1e-300)
    return depth, normal, origin + np.where(np.isfinite(depth), depth, 0)[..., None] * camera.look


def _phi(collider: Json, x: Array, t: float) -> Array:
    """φ(x) at time t of a collider that _visible() let through: its shape is analytic."""
    phi = collider_distance(collider, x, t)
    assert phi is not None
    return phi


def _trace(collider: Json, origin: Array, camera: Camera, t: float) -> Array:
    """Depth of one collider along every ray, infinite where the ray misses."""
    start = _phi(collider, origin, t)
    if collider["shape"]["type"] == "half-space":
        # φ is linear along a ray: one exact step.
        slope = start - _phi(collider, origin + camera.look, t)
        return np.where(
            slope > 1e-9, np.maximum(start, 0) / np.where(slope > 1e-9, slope, 1), np.inf
        )
    far = 25 * camera.pixel * camera.width
    depth = np.full(start.shape, 0.0)
    active = np.ones(start.shape, bool)
    for _ in range(60):
        phi = _phi(collider, origin[active] + depth[active][:, None] * camera.look, t)
        depth[active] += np.maximum(phi, 0)
        going = (phi > 0.02 * camera.pixel) & (depth[active] < far)
        active[active] = going
        if not active.any():
            return np.where(depth < far, depth, np.inf)
    # Rays still under way graze a rim: they hit only what they have come within a pixel of.
    phi = _phi(collider, origin + depth[..., None] * camera.look, t)
    return np.where((depth < far) & (phi < camera.pixel), depth, np.inf)


def _visible(collider: Json, camera: Camera) -> bool:
    """Containers and walls between the camera and the snow would hide it."""
    shape = collider["shape"]
    if collider.get("inside", False) or shape["type"] in ("mesh", "level-set"):
        return False
    return shape["type"] != "half-space" or bool(unit(shape["normal"]) @ camera.look < -0.05)
