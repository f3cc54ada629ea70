# SPDX-License-Identifier: BSD-3-Clause
"""A trajectory of a ball that falls and is flattened."""

import h5py
import numpy as np

SCENE = """name = "synthetic snowball"
gravity = [0.0, 0.0, -9.81]
[grid]
spacing = 0.05
[time]
end = 0.6
step = 1e-3
frames_per_second = 20
[transfer]
flip = 0.95
[[material]]
name = "snow"
youngs_modulus = 1.4e5
poisson_ratio = 0.2
density = 400.0
hardening = 10.0
critical_compression = 2.5e-2
critical_stretch = 7.5e-3
[[body]]
material = "snow"
shape = { type = "sphere", center = [0.0, 0.0, 1.0], radius = 0.3 }
particles_per_cell = 8
sampling = "jittered"
seed = 1
[[collider]]
shape = { type = "half-space", point = [0.0, 0.0, 0.0], normal = [0.0, 0.0, 1.0] }
friction = 0.3
"""
G = np.array([0.0, 0.0, -9.81])


def _ball(particles, seed):
    random = np.random.default_rng(seed)
    x = random.uniform(-0.3, 0.3, (4 * particles, 3))
    x = x[np.linalg.norm(x, axis=1) < 0.3][:particles]
    return x - x.mean(axis=0)


def write_trajectory(path, particles=3000, steps=600, frames=13, spare=0, scene=SCENE):
    """A ball that falls by the exact discrete law, then is flattened on the ground.

    `spare` rows of rubbish behind the valid ones imitate an interrupted file.
    """
    ball = _ball(particles, 1)
    n = len(ball)
    m = np.full(n, 400 * 0.05**3 / 8)
    dt = 1e-3
    k = np.arange(1, steps + 1)
    height = 1.0 + G[2] * dt**2 * k * (k + 1) / 2
    speed = G[2] * dt * k
    rest = 0.16
    landed = height < rest + 0.1
    height[landed], speed[landed] = rest + 0.1, 0.0

    with h5py.File(path, "w", track_order=True) as file:
        firn = file.create_group("firn")
        for name, value in {
            "format": "firn-trajectory",
            "version": 1,
            "solver": "synthetic",
            "precision": "double",
            "threads": 1,
            "firn_version": "0.1.0",
            "processor": "none",
            "scene": scene,
        }.items():
            firn.attrs[name] = value
        _write_diagnostics(
            firn.create_group("diagnostics"), m.sum(), dt, k, height, speed, landed, spare
        )

        vtk = file.create_group("VTKHDF")
        vtk.attrs["Type"] = np.bytes_("PolyData")
        vtk.attrs["Version"] = [2, 0]
        vtk["NumberOfPoints"] = np.full(frames + spare, n)
        every = np.linspace(0, steps, frames).astype(int)
        points, J_P = [], []
        for step in every:
            z = height[step - 1] if step else 1.0
            squash = min(1.0, z / 0.5)
            points.append(ball * [1 / np.sqrt(squash), 1 / np.sqrt(squash), squash] + [0, 0, z])
            J_P.append(np.clip(1 - (1 - squash) * (0.4 + ball[:, 2]), 0.6, 1.1))
        _write_frames(vtk, points, J_P, m, every * dt, spare)
    return path


def _write_diagnostics(table, mass, dt, k, height, speed, landed, spare):
    rows = len(k)
    zero = np.zeros(rows)

    def vector(z):
        return np.stack([zero, zero, z], axis=1)

    columns = {
        "time": (k * dt, "s"),
        "dt": (zero + dt, "s"),
        "mass": (zero + mass, "kg"),
        "momentum": (vector(mass * speed), "kg m/s"),
        "angular_momentum": (vector(zero), "kg m²/s"),
        "kinetic_energy": (0.5 * mass * speed**2, "J"),
        "elastic_energy": (np.where(landed, 3.0, 0.0), "J"),
        "gravitational_energy": (-mass * G[2] * height, "J"),
        "center_of_mass": (vector(height), "m"),
        "max_speed": (np.abs(speed), "m/s"),
        "min_J_E": (np.where(landed, 0.95, 1.0), "1"),
        "max_J_E": (np.where(landed, 1.01, 1.0), "1"),
        "grid_nodes": (zero + 4000, "1"),
        "solver_iterations": (zero, "1"),
    }
    table.attrs["rows"] = rows
    for name, (values, units) in columns.items():
        rubbish = np.full((spare, *values.shape[1:]), -12345.0)
        table[name] = np.concatenate([values, rubbish])
        table[name].attrs["units"] = units


def _write_frames(vtk, points, J_P, m, times, spare):
    n, frames = len(m), len(points)
    rubbish = np.full((spare * n, 3), np.nan)
    vtk["Points"] = np.concatenate([*points, rubbish])
    data = vtk.create_group("PointData")
    total = frames + spare
    F_P = np.concatenate(
        [np.cbrt(j)[:, None] * np.eye(3).ravel() for j in J_P] + [np.zeros((spare * n, 9))]
    )
    for name, values in {
        "velocity": np.zeros((total * n, 3)),
        "mass": np.tile(m, total),
        "volume": np.full(total * n, 0.05**3 / 8),
        "F_E": np.tile(np.eye(3).ravel(), (total * n, 1)),
        "F_P": F_P,
        "id": np.tile(np.arange(n), total),
        "material": np.zeros(total * n, np.int32),
    }.items():
        data[name] = values
    steps = vtk.create_group("Steps")
    steps.attrs["NSteps"] = frames
    steps["Values"] = np.concatenate([times, np.full(spare, -1.0)])
    steps["PointOffsets"] = np.arange(total) * n
    steps["PartOffsets"] = np.arange(total)
