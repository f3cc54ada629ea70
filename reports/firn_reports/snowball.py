"""A picture of the particles: spheres in a depth buffer, lit, with the colliders and their shadows.

NumPy only. Orthographic camera; the particles are splatted far to near, the
analytic colliders are sphere-traced through their signed distances.
"""

import copy
import io
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import LinearSegmentedColormap, LogNorm
from matplotlib.figure import Figure

from .colliders import collider_distance, unit
from .kinds import Array, Indices, Json
from .trajectory import Frame

# Compacted snow is blue, untouched snow white, loosened snow amber.
SNOW = LinearSegmentedColormap.from_list(
    "snow",
    [(0.00, "#1e5fb0"), (0.25, "#74a9dc"), (0.5, "#f4f7fa"), (0.75, "#f3c27a"), (1.00, "#d97b1c")],
)
SKY_TOP, SKY_BOTTOM = np.array([0.10, 0.14, 0.20]), np.array([0.27, 0.34, 0.43])
SOLID = np.array([0.42, 0.47, 0.53])
LIGHT = unit([-0.38, -0.35, 0.85])
SUPERSAMPLE = 2


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


def blur(image: Array, radius: int) -> Array:
    """Three box passes, nearly a Gaussian."""
    for _ in range(3):
        for axis in (0, 1):
            image = _box(image, radius, axis)
    return image


def _box(image: Array, radius: int, axis: int) -> Array:
    n = image.shape[axis]
    padding = [(0, 0)] * image.ndim
    padding[axis] = (radius + 1, radius)
    total = np.cumsum(np.pad(image, padding, mode="edge"), axis=axis)
    high = np.take(total, range(2 * radius + 1, n + 2 * radius + 1), axis=axis)
    low = np.take(total, range(n), axis=axis)
    return (high - low) / (2 * radius + 1)


def splat(camera: Camera, frame: Frame) -> tuple[Array, Indices, int]:
    """Depth and particle index per pixel; index −1 where there is none."""
    depth = np.full(camera.width * camera.height, np.inf)
    index = np.full(camera.width * camera.height, -1)
    column, row, d = camera.project(frame.x)
    spacing = np.cbrt(np.median(frame.volume)) if np.median(frame.volume) > 0 else 2 * camera.pixel
    radius = min(max(0.8 * spacing / camera.pixel, 1.5), 40.0)
    order = np.argsort(-d)
    c, r, d = column[order].astype(int), row[order].astype(int), d[order]
    reach = int(np.ceil(radius))
    for dr in range(-reach, reach + 1):
        for dc in range(-reach, reach + 1):
            bulge = radius**2 - dr**2 - dc**2
            if bulge < 0:
                continue
            surface = d - np.sqrt(bulge) * camera.pixel
            inside = (
                (c + dc >= 0) & (c + dc < camera.width) & (r + dr >= 0) & (r + dr < camera.height)
            )
            pixel = ((r + dr) * camera.width + c + dc)[inside]
            nearer = surface[inside] < depth[pixel]
            # Sorted far to near: among equals of one offset the nearest is written last.
            depth[pixel[nearer]] = surface[inside][nearer]
            index[pixel[nearer]] = order[inside][nearer]
    shape = (camera.height, camera.width)
    return depth.reshape(shape), index.reshape(shape), max(int(radius), 1)


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


def shadow(camera: Camera, frame: Frame, point: Array) -> Array:
    """Share of light that reaches `point`: particles counted in columns along the light."""
    a = unit(np.cross(LIGHT, [0.0, 1.0, 0.0]))
    b = np.cross(LIGHT, a)
    cell = 4 * camera.pixel
    u, v = frame.x @ a / cell, frame.x @ b / cell
    u0, v0 = np.floor(u.min()) - 20, np.floor(v.min()) - 20
    shape = (int(u.max() - u0) + 21, int(v.max() - v0) + 21)
    count = np.zeros(shape)
    np.add.at(count, ((u - u0).astype(int), (v - v0).astype(int)), 1.0)
    share = blur(np.minimum(count, 1.0), 2)
    pu, pv = (point @ a / cell - u0).astype(int), (point @ b / cell - v0).astype(int)
    seen = (pu >= 0) & (pu < shape[0]) & (pv >= 0) & (pv < shape[1])
    return 1 - 0.62 * np.where(
        seen, share[np.clip(pu, 0, shape[0] - 1), np.clip(pv, 0, shape[1] - 1)], 0
    )


def render(scene: Json, frame: Frame, camera: Camera, norm: LogNorm) -> Array:
    """One frame as an RGB image (height, width, 3) in [0, 1]."""
    rows = np.linspace(0, 1, camera.height)[:, None, None]
    image = np.broadcast_to(
        SKY_TOP * (1 - rows) + SKY_BOTTOM * rows, (camera.height, camera.width, 3)
    ).copy()

    solid_depth, solid_normal, point = (
        np.repeat(np.repeat(field, SUPERSAMPLE, 0), SUPERSAMPLE, 1)
        for field in trace_colliders(camera.coarse(SUPERSAMPLE), scene, frame.time)
    )
    solid = np.isfinite(solid_depth)
    lambert = np.clip(solid_normal @ LIGHT, 0, 1)
    lit = SOLID * (0.35 + 0.75 * lambert * shadow(camera, frame, point))[..., None]
    # Far ground fades into the sky.
    behind = np.where(solid, solid_depth, 0) - camera.middle
    haze = 1 - np.exp(-np.maximum(behind, 0) / (2.0 * camera.pixel * camera.height))
    image = np.where(solid[..., None], lit * (1 - haze[..., None]) + image * haze[..., None], image)

    depth, index, radius = splat(camera, frame)
    snow = (index >= 0) & (depth < solid_depth + 2 * camera.pixel)
    if not snow.any():
        return image
    filled = np.where(snow, depth, 0)
    weight = np.maximum(blur(snow.astype(float), radius), 1e-9)
    smooth = blur(filled, radius) / weight
    wide = blur(filled, 5 * radius) / np.maximum(blur(snow.astype(float), 5 * radius), 1e-9)
    surface = 0.75 * smooth + 0.25 * np.where(snow, depth, smooth)
    slope_row: Array = np.gradient(surface, camera.pixel, axis=0)
    slope_column: Array = np.gradient(surface, camera.pixel, axis=1)
    normal = (
        slope_column[..., None] * camera.right
        - slope_row[..., None] * camera.screen_up
        - camera.look
    )
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    # Crevices lie deeper than what surrounds them: darken those, lift the ridges.
    relief = np.clip((wide - np.where(snow, depth, wide)) / (12 * radius * camera.pixel), -1, 1)
    light = 0.40 + 0.66 * np.clip(normal @ LIGHT, 0, 1) + 0.16 * relief
    colour = SNOW(norm(frame.J_P))[:, :3][np.where(snow, index, 0)]
    return np.where(snow[..., None], np.clip(colour * light[..., None], 0, 1), image)


def downsample(image: Array, factor: int) -> Array:
    """Mean over squares of `factor` pixels; (h, w, 3) to (h // factor, w // factor, 3)."""
    h, w = image.shape[0] // factor, image.shape[1] // factor
    return image[: h * factor, : w * factor].reshape(h, factor, w, factor, 3).mean(axis=(1, 3))


def with_volumes(frames: Sequence[Frame]) -> list[Frame]:
    """The frames, each with volumes: a frame before the first step gets those of a later one.

    A volume of 0 says "not known yet".
    """
    known = next((f.volume for f in frames if np.median(f.volume) > 0), None)
    return [
        replace(f, volume=known)
        if known is not None and np.median(f.volume) == 0 and len(f.volume) == len(known)
        else f
        for f in frames
    ]


def picture(scene: Json, frames: Sequence[Frame], width: int = 1500, height: int = 560) -> bytes:
    """The frames side by side with their times and the scale of J_P, as PNG bytes."""
    frames = with_volumes(frames)
    across = width // len(frames)
    # In ln J_P, so that half the volume stands as far from white as twice the volume.
    J_P = np.concatenate([f.J_P for f in frames])
    deviation = max(np.abs(np.log(np.percentile(np.maximum(J_P, 1e-3), [1, 99]))).max(), 0.02)
    norm = LogNorm(np.exp(-deviation), np.exp(deviation), clip=True)
    camera = Camera(scene, [f.x for f in frames], across * SUPERSAMPLE, height * SUPERSAMPLE)
    image = np.concatenate(
        [downsample(render(scene, f, camera, norm), SUPERSAMPLE) for f in frames], axis=1
    )

    figure = Figure(figsize=(image.shape[1] / 100, image.shape[0] / 100), dpi=100)
    figure.set_layout_engine("none")
    FigureCanvasAgg(figure)
    axes = figure.add_axes((0, 0, 1, 1))
    axes.imshow(np.clip(image, 0, 1), interpolation="none", aspect="auto")
    axes.axis("off")
    for i, frame in enumerate(frames):
        axes.text(
            (i + 0.05) * across,
            0.085 * height,
            f"t = {frame.time:.3g} s",
            color="white",
            fontsize=15,
        )
        if i:
            axes.axvline(i * across - 0.5, color="white", alpha=0.25, linewidth=1)
    bar = figure.add_axes((0.80, 0.925, 0.17, 0.025))
    bar.imshow(
        np.linspace(0, 1, 256)[None, :],
        cmap=SNOW,
        aspect="auto",
        extent=(-deviation, deviation, 0, 1),
    )
    bar.set_yticks([])
    bar.set_xticks(
        [-deviation, 0.0, deviation],
        [f"{norm.vmin:.2f}\ncompacted", "1\n$J_P$", f"{norm.vmax:.2f}\nloosened"],
    )
    bar.tick_params(colors="white", labelcolor="white", labelsize=10, length=3)
    bar.grid(False)
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png")
    return buffer.getvalue()
