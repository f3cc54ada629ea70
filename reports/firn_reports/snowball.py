# SPDX-License-Identifier: BSD-3-Clause
"""A picture of the particles: spheres in a depth buffer, lit, with the colliders and their shadows.

NumPy only. Orthographic camera; the particles are splatted far to near, the
analytic colliders are sphere-traced through their signed distances.
"""

import io
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import LinearSegmentedColormap, LogNorm
from matplotlib.figure import Figure

from .camera import Camera
from .colliders import unit
from .kinds import Array, Indices, Json
from .tracing import trace_colliders
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
