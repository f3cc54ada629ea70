# SPDX-License-Identifier: BSD-3-Clause
"""The picture shows particles where they are, in the colour of their J_P."""

import numpy as np

from firn_reports import snowball, tracing
from firn_reports.camera import Camera
from firn_reports.trajectory import Frame


def frame(x, J_P):
    n = len(x)
    return Frame(
        0.0,
        np.asarray(x, float),
        np.zeros((n, 3)),
        np.ones(n),
        np.full(n, 1e-3),
        np.asarray(J_P, float),
    )


def block():
    return np.stack(np.meshgrid(*[np.linspace(0, 1, 12)] * 3), axis=-1).reshape(-1, 3)


def test_the_nearer_of_two_particles_is_seen():
    near, far = [0.0, -1.0, 0.0], [0.0, 1.0, 0.0]
    camera = Camera({}, [np.array([near, far, [-3, 0, 0], [3, 0, 0]])], 200, 100)
    camera.look, camera.right, camera.screen_up = (
        np.array([0.0, 1, 0]),
        np.array([1.0, 0, 0]),
        np.array([0, 0, 1.0]),
    )
    camera.near = -5.0
    for order in ([near, far], [far, near]):
        _, index, _ = snowball.splat(camera, frame(order, [1, 1]))
        column, row, _ = camera.project(np.array([near]))
        assert order[index[int(row[0]), int(column[0])]] == near


def test_blur_keeps_the_mean_and_constant_images():
    image = np.pad(np.random.default_rng(0).uniform(size=(20, 30)), 20)
    assert np.isclose(snowball.blur(image, 3).sum(), image.sum())
    assert np.allclose(snowball.blur(np.full((9, 9), 2.0), 4), 2.0)


def test_compacted_snow_is_blue_and_loosened_snow_is_amber():
    scene = {"gravity": [0, 0, -9.81]}
    norm = snowball.LogNorm(0.8, 1.25)
    colours = []
    for J_P in (0.8, 1.2):
        f = frame(block(), np.full(12**3, J_P))
        colours.append(snowball.render(scene, f, Camera(scene, [f.x], 120, 120), norm)[60, 60])
    assert colours[0][2] > colours[0][0]
    assert colours[1][0] > colours[1][2]


def test_ground_is_drawn_below_and_shaded_under_the_body():
    ground = {"shape": {"type": "half-space", "point": [0, 0, 0], "normal": [0, 0, 1]}}
    scene = {"gravity": [0, 0, -9.81], "collider": [ground]}
    f = frame(block() + np.array([0, 0, 0.1]), np.ones(12**3))
    camera = Camera(scene, [f.x], 160, 160)
    depth, normal, point = tracing.trace_colliders(camera, scene, 0.0)
    assert np.isfinite(depth).all()
    assert np.allclose(point[..., 2], 0, atol=1e-9)
    assert np.allclose(normal[80, 80], [0, 0, 1])
    light = snowball.shadow(camera, f, np.array([[[0.5, 0.5, 0.0]], [[30.0, 30.0, 0.0]]]))
    assert light[0, 0] < 0.6
    assert light[1, 0] == 1.0


def test_a_ball_as_collider_is_met_at_its_near_side():
    scene = {"collider": [{"shape": {"type": "sphere", "center": [0, 0, 0], "radius": 1.0}}]}
    camera = Camera(scene, [np.array([[-2.0, -2, -2], [2, 2, 2]])], 101, 101)
    depth, normal, point = tracing.trace_colliders(camera, scene, 0.0)
    hit = np.isfinite(depth)
    # The disc of a unit sphere covers π m²; its rim is 2π/pixel pixels long, half of them in doubt.
    assert abs(hit.sum() * camera.pixel**2 - np.pi) < np.pi * camera.pixel
    assert np.allclose(np.linalg.norm(point[hit], axis=-1), 1.0, atol=2 * camera.pixel)
    # A pixel past the rim of a unit sphere its normal leans away by at most √(2 pixel).
    assert (normal[hit] @ camera.look < np.sqrt(2 * camera.pixel)).all()


def test_a_frame_before_the_first_step_is_drawn_with_the_volumes_of_a_later_one():
    later = Frame(1.0, np.zeros((2, 3)), np.zeros((2, 3)), np.ones(2), np.full(2, 8e-6), np.ones(2))
    first = Frame(0.0, np.zeros((2, 3)), np.zeros((2, 3)), np.ones(2), np.zeros(2), np.ones(2))
    drawn = snowball.with_volumes([first, later])
    assert (drawn[0].volume == later.volume).all()
    assert drawn[1] is later
    assert snowball.with_volumes([first])[0] is first
