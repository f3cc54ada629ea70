# SPDX-License-Identifier: BSD-3-Clause
"""Signed distances of a scene's analytic colliders, for pictures and the reach of free flight."""

import numpy as np
from numpy.typing import ArrayLike

from .kinds import Array, Json


def unit(vector: ArrayLike) -> Array:
    """The vector (3,) divided by its length."""
    vector = np.asarray(vector, float)
    return vector / np.linalg.norm(vector)


def rotation(omega: ArrayLike, t: float) -> Array:
    """R(t): turns by |ω|t about ω (Rodrigues)."""
    omega = np.asarray(omega, float)
    rate = np.linalg.norm(omega)
    if rate == 0:
        return np.eye(3)
    k = omega / rate
    K = np.array([[0, -k[2], k[1]], [k[2], 0, -k[0]], [-k[1], k[0], 0]])
    return np.eye(3) + np.sin(rate * t) * K + (1 - np.cos(rate * t)) * K @ K


def shape_center(shape: Json) -> Array:
    """The point (3,) [m] about which a collider of this shape turns."""
    if shape["type"] == "box":
        return (np.asarray(shape["min"], float) + np.asarray(shape["max"], float)) / 2
    return np.asarray(shape.get("center", shape.get("point", [0, 0, 0])), float)


def distance(shape: Json, x: Array) -> Array | None:
    """φ(x) of an analytic shape, None for one that only a file describes."""
    kind = shape["type"]
    if kind == "half-space":
        return (x - np.asarray(shape["point"], float)) @ unit(shape["normal"])
    if kind == "sphere":
        return np.linalg.norm(x - np.asarray(shape["center"], float), axis=-1) - shape["radius"]
    if kind == "box":
        half = (np.asarray(shape["max"], float) - np.asarray(shape["min"], float)) / 2
        q = np.abs(x - shape_center(shape)) - half
        return np.linalg.norm(np.maximum(q, 0), axis=-1) + np.minimum(q.max(axis=-1), 0)
    if kind == "cylinder":
        d = x - np.asarray(shape["center"], float)
        along = d @ unit(shape["axis"])
        radial = np.sqrt(np.maximum((d * d).sum(axis=-1) - along**2, 0))
        q = np.stack([radial - shape["radius"], np.abs(along) - shape["height"] / 2], axis=-1)
        return np.linalg.norm(np.maximum(q, 0), axis=-1) + np.minimum(q.max(axis=-1), 0)
    return None


def collider_distance(collider: Json, x: Array, t: float) -> Array | None:
    """φ at time t: the point is carried into the shape's own frame."""
    shape = collider["shape"]
    c = np.asarray(collider.get("center", shape_center(shape)), float)
    moved = x - c - t * np.asarray(collider.get("velocity", [0, 0, 0]), float)
    local = c + moved @ rotation(collider.get("angular_velocity", [0, 0, 0]), t)
    phi = distance(shape, local)
    if phi is None:
        return None
    return -phi if collider.get("inside", False) else phi


def free_flight_reach(scene: Json, x: Array) -> float | None:
    """How far the body x may travel before a node that it touches can lie in a collider [m].

    A particle touches nodes up to 2h away along each axis, at most 2√3 h in all.
    Infinite without colliders, None where a collider moves or only a file knows it.
    """
    reach = np.inf
    for collider in scene.get("collider", []):
        moves = np.any(collider.get("velocity", 0)) or np.any(collider.get("angular_velocity", 0))
        phi = None if moves else collider_distance(collider, x, 0.0)
        if phi is None:
            return None
        reach = min(reach, phi.min() - 2 * np.sqrt(3) * scene["grid"]["spacing"])
    return max(reach, 0.0)
