# SPDX-License-Identifier: BSD-3-Clause
"""The material point method for snow (Stomakhin et al. 2013, section 4.1) in NumPy.

    firn check tiny_impact --solver "exec:python3 mpm.py {in} {out} {steps}"

Reads the last frame of a trajectory and the scene stored with it, takes steps, writes a
trajectory of one frame. Explicit scenes; colliders may be half-spaces, spheres and boxes.
The symbols are the paper's; arrays run over particles p or nodes i first. SI units.
"""

import sys
import tomllib
from typing import Any, NoReturn

import h5py
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Scene = dict[str, Any]
State = dict[str, Any]  # the arrays of the particles, by symbol
ARRAYS = {
    "v": "velocity",
    "m": "mass",
    "V_0": "volume",
    "F_E": "F_E",
    "F_P": "F_P",
    "id": "id",
    "material": "material",
}


UNSUPPORTED = 77  # exit status: Firn reports that the scene does not apply to this solver
MOST_CELLS = 1e9  # between the origin and a particle


def unsupported(what: str) -> NoReturn:
    """Tells Firn that this solver does not do what the scene asks for."""
    print(f"mpm.py: {what}", file=sys.stderr)
    sys.exit(UNSUPPORTED)


def check(scene: Scene, s: State) -> None:
    """Refuses numbers that no step could make right again."""
    for key in "x", "v", "m", "V_0", "F_E", "F_P":
        bad = ~np.isfinite(s[key]).all(axis=tuple(range(1, s[key].ndim)))
        if bad.any():
            sys.exit(f"mpm.py: {key} of particle {bad.argmax()} is not finite")
    for what, bad in ("no positive mass", s["m"] <= 0), ("a negative volume", s["V_0"] < 0):
        if bad.any():
            sys.exit(f"mpm.py: particle {bad.argmax()} has {what}")
    cells = np.abs(s["x"] - scene["grid"]["origin"]) / scene["grid"]["spacing"]
    bad = ~(cells < MOST_CELLS).all(1)
    if bad.any():
        sys.exit(f"mpm.py: particle {bad.argmax()} is outside the grid's range")


def read(path: str) -> tuple[Scene, State, float]:
    """Scene, particles and time [s] of the last frame."""
    with h5py.File(path) as file:
        scene = tomllib.loads(file["firn"].attrs["scene"])
        vtk = file["VTKHDF"]
        n = vtk["NumberOfPoints"][0]
        first = vtk["Steps/PointOffsets"][vtk["Steps"].attrs["NSteps"] - 1]
        state = {key: vtk["PointData"][name][first : first + n] for key, name in ARRAYS.items()}
        state["x"] = vtk["Points"][first : first + n]
        time = vtk["Steps/Values"][-1]
    for key in "F_E", "F_P":
        state[key] = state[key].reshape(n, 3, 3)
    return scene, state, time


def write(path: str, state: State, time: float) -> None:
    """A trajectory of one frame."""
    n = len(state["x"])
    with h5py.File(path, "w") as file:
        vtk = file.create_group("VTKHDF")
        vtk.attrs["Version"] = [2, 0]
        vtk.attrs["Type"] = np.bytes_("PolyData")
        vtk["NumberOfPoints"] = [n]
        vtk["Points"] = state["x"]
        for key, name in ARRAYS.items():
            value = state[key]
            vtk["PointData/" + name] = value.reshape(n, 9) if value.ndim == 3 else value
        steps = vtk.create_group("Steps")
        steps.attrs["NSteps"] = 1
        steps["Values"] = [time]
        steps["NumberOfParts"] = [1]
        steps["PartOffsets"] = steps["PointOffsets"] = [0]


def stencil(x: Array, scene: Scene) -> tuple[NDArray[np.int_], NDArray[np.int_], Array, Array]:
    """The nodes (i,j,k) that occur, for each particle the 64 it touches, w_ip and its gradient."""
    h = scene["grid"]["spacing"]
    X = (x - scene["grid"]["origin"]) / h
    s = X - np.floor(X)  # the four nodes along an axis are 1+s, s, 1-s, 2-s away
    t = 1 - s
    N = np.stack([t**3 / 6, (s / 2 - 1) * s**2 + 2 / 3, (t / 2 - 1) * t**2 + 2 / 3, s**3 / 6], 2)
    dN = np.stack([-(t**2) / 2, (1.5 * s - 2) * s, -(1.5 * t - 2) * t, s**2 / 2], 2) / h

    def product(a: Array, b: Array, c: Array) -> Array:
        return np.einsum("pi,pj,pk->pijk", a[:, 0], b[:, 1], c[:, 2]).reshape(len(x), 64)

    w = product(N, N, N)
    grad_w = np.stack([product(dN, N, N), product(N, dN, N), product(N, N, dN)], 2)
    near = np.floor(X).astype(int)[:, None] - 1 + np.indices((4, 4, 4)).reshape(3, 64).T
    for axis, period in enumerate(scene["grid"]["periodic"]):
        if period > 0:
            near[:, :, axis] %= round(period / h)
    node, at = np.unique(near.reshape(-1, 3), axis=0, return_inverse=True)
    return node, at.reshape(len(x), 64), w, grad_w


def scatter(at: NDArray[np.int_], values: Array, nodes: int) -> Array:
    """Sums values (p, 64, ...) at the nodes."""
    total = np.zeros((nodes, *values.shape[2:]))
    np.add.at(total, at, values)
    return total


def svd(F: Array) -> tuple[Array, Array, Array]:
    """F = U diag(sigma) V^T with rotations U and V; the last sigma has the sign of det F."""
    U, sigma, VT = np.linalg.svd(F)
    for matrix, column in (U, np.s_[:, :, 2]), (VT, np.s_[:, 2, :]):
        flip = np.where(np.linalg.det(matrix) < 0, -1.0, 1.0)
        matrix[column] *= flip[:, None]
        sigma[:, 2] *= flip
    return U, sigma, VT


def rotation(omega: Array, t: float) -> Array:
    """Rodrigues' formula: turns by |omega| t about omega."""
    angle = np.linalg.norm(omega) * t
    if angle == 0:
        return np.eye(3)
    K = np.cross(np.eye(3), omega / np.linalg.norm(omega))  # K x = omega x x / |omega|
    return np.eye(3) + np.sin(angle) * K + 2 * np.sin(angle / 2) ** 2 * K @ K


def distance(shape: dict[str, Any], X: Array) -> tuple[Array, Array]:
    """Signed distance phi and outward normal n of a collider's shape."""
    if shape["type"] == "half-space":
        n = np.array(shape["normal"]) / np.linalg.norm(shape["normal"])
        return (X - shape["point"]) @ n, np.broadcast_to(n, X.shape)
    if shape["type"] == "sphere":
        r = X - shape["center"]
        length = np.linalg.norm(r, axis=1)
        return length - shape["radius"], r / length[:, None]
    if shape["type"] == "box":
        low, high = shape["min"] - X, X - shape["max"]
        beyond, side = np.maximum(low, high), np.where(high >= low, 1.0, -1.0)
        inside = beyond.max(1) <= 0  # the nearest face; outside, the nearest point of the box
        face = np.eye(3)[beyond.argmax(1)] * side
        out = np.maximum(beyond, 0)
        length = np.linalg.norm(out, axis=1)
        n = np.where(inside[:, None], face, out * side / np.where(inside, 1, length)[:, None])
        return np.where(inside, beyond.max(1), length), n
    unsupported(f"collider of shape {shape['type']}, supported: half-space, sphere, box")


def collide(scene: Scene, t: float, x: Array, v: Array) -> Array:
    """Contact with every collider in turn (section 8): stick, or slide with Coulomb friction."""
    for c in scene.get("collider", []):
        R, center = rotation(c["angular_velocity"], t), c["center"] + t * np.array(c["velocity"])
        phi, n = distance(c["shape"], (x - center) @ R + c["center"])  # in the shape's own frame
        side = -1 if c.get("inside") else 1
        phi, n = side * phi, side * n @ R.T
        v_co = c["velocity"] + np.cross(c["angular_velocity"], x - center)
        v_rel = v - v_co
        v_n = np.sum(v_rel * n, 1)
        v_t = v_rel - n * v_n[:, None]
        slip = np.linalg.norm(v_t, axis=1)
        sticky, mu = c.get("sticky", False), c.get("friction", 0.0)
        touches = (phi <= 0) & (sticky | (v_n < 0))
        slides = (slip > -mu * v_n) & (not sticky)
        keep = np.where(slides, 1 + mu * v_n / np.where(slides, slip, 1), 0)
        v = np.where(touches[:, None], keep[:, None] * v_t + v_co, v)
    return v


def step(scene: Scene, s: State, t: float) -> float:
    """One time step: changes the particles `s`, returns the new time [s]."""
    dt, alpha = scene["time"]["step"], scene["transfer"]["flip"]
    h, origin = scene["grid"]["spacing"], np.array(scene["grid"]["origin"])

    def of_particle(key: str) -> Array:
        return np.array([float(m[key]) for m in scene["material"]])[s["material"]]

    node, at, w, grad_w = stencil(s["x"], scene)
    # 1. rasterize; a node that happens to get no mass takes no part
    m_i = scatter(at, w * s["m"][:, None], len(node))
    m_1 = np.where(m_i > 0, m_i, 1)[:, None]
    v_i = scatter(at, (w * s["m"][:, None])[:, :, None] * s["v"][:, None, :], len(node)) / m_1
    # 2. volumes, where they are not known yet
    rho = np.sum(m_i[at] * w, 1) / h**3
    s["V_0"] = np.where(s["V_0"] > 0, s["V_0"], s["m"] / rho)
    # 3. grid forces
    harder = np.exp(of_particle("hardening") * (1 - np.linalg.det(s["F_P"])))
    E, nu = of_particle("youngs_modulus") * harder, of_particle("poisson_ratio")
    mu, lam = E / (2 * (1 + nu)), E * nu / ((1 + nu) * (1 - 2 * nu))
    F = s["F_E"]
    U, _, VT = svd(F)
    J = np.linalg.det(F)
    tau = 2 * mu[:, None, None] * (F - U @ VT) @ F.transpose(0, 2, 1)
    tau += (lam * (J - 1) * J)[:, None, None] * np.eye(3)
    V_tau = s["V_0"][:, None, None] * tau
    f_i = -scatter(at, grad_w @ V_tau.transpose(0, 2, 1), len(node))
    # 4. grid velocities
    v_star = v_i + dt * (f_i / m_1 + scene["gravity"])
    # 5. grid collisions, 6. integration (explicit: nothing to solve)
    v_new = collide(scene, t, origin + h * node, v_star)
    # 7. deformation: all of it elastic at first, what exceeds the limits becomes plastic
    grad_v = v_new[at].transpose(0, 2, 1) @ grad_w
    F = (np.eye(3) + dt * grad_v) @ F
    U, sigma, VT = svd(F)
    low, high = 1 - of_particle("critical_compression"), 1 + of_particle("critical_stretch")
    limited = np.clip(sigma, low[:, None], high[:, None])
    clamped = np.any(limited != sigma, 1)[:, None, None]
    F_P = (VT.transpose(0, 2, 1) / limited[:, None, :]) @ U.transpose(0, 2, 1) @ F @ s["F_P"]
    s["F_E"] = np.where(clamped, (U * limited[:, None, :]) @ VT, F)
    s["F_P"] = np.where(clamped, F_P, s["F_P"])
    # 8. particle velocities
    v_pic = np.einsum("pa,pak->pk", w, v_new[at])
    v_flip = s["v"] + np.einsum("pa,pak->pk", w, (v_new - v_i)[at])
    s["v"] = (1 - alpha) * v_pic + alpha * v_flip
    # 9. particle collisions, 10. positions
    s["v"] = collide(scene, t, s["x"], s["v"])
    s["x"] = s["x"] + dt * s["v"]
    for axis, period in enumerate(scene["grid"]["periodic"]):
        if period > 0:
            s["x"][:, axis] = origin[axis] + (s["x"][:, axis] - origin[axis]) % period
    return t + dt


def main(path_in: str, path_out: str, steps: str) -> None:
    """Reads a trajectory, takes steps, writes the result."""
    scene, state, t = read(path_in)
    if scene["integrator"]["type"] != "explicit":
        unsupported("semi-implicit scene, supported: explicit")
    check(scene, state)
    for _ in range(int(steps)):
        t = step(scene, state, t)
        check(scene, state)
    write(path_out, state, t)


if __name__ == "__main__":
    main(*sys.argv[1:])
