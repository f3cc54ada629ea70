# SPDX-License-Identifier: BSD-3-Clause
"""A trajectory file: the temporal PolyData layout under /VTKHDF and Firn's own part under /firn."""

import tomllib
from dataclasses import dataclass, field
from pathlib import Path

import h5py
import numpy as np

from . import InputError, checked
from .kinds import Array, Json

DIAGNOSTICS = [
    "time",
    "dt",
    "mass",
    "momentum",
    "angular_momentum",
    "kinetic_energy",
    "elastic_energy",
    "gravitational_energy",
    "center_of_mass",
    "max_speed",
    "min_J_E",
    "max_J_E",
    "grid_nodes",
    "solver_iterations",
]


VECTORS = ("momentum", "angular_momentum", "center_of_mass")


def finite_rows(table: h5py.Group, name: str, shape: list[int | None], rows: int) -> Array:
    """The rows that count: what is beyond them in an interrupted file is not judged."""
    values = checked.numbers(table, name, shape, finite=False)
    if not 0 <= rows <= len(values):
        raise InputError(
            f"{checked.where(table)}: attribute rows: got {rows}, "
            f"allowed: 0 to {len(values)}, the length of {name}"
        )
    bad = np.argwhere(~np.isfinite(values[:rows]))
    if len(bad):
        raise InputError(
            f"{checked.where(table)}/{name}: row {bad[0][0]}: "
            f"got {values[tuple(bad[0])]}, allowed: finite"
        )
    return values[:rows]


def text_attribute(node: h5py.HLObject, name: str, default: str = "") -> str:
    """An attribute as text, `default` if there is none."""
    value = node.attrs.get(name, default)
    return value.decode() if isinstance(value, bytes) else str(value)


def particle_rows(group: h5py.Group, name: str, rows: slice, components: int) -> Array:
    """Some rows of an array with one row per particle and frame.

    Raises InputError if it has not these rows, or one of them is not finite.
    """
    data = group.get(name)
    shape = data.shape if isinstance(data, h5py.Dataset) else None
    tail = () if components == 1 else (components,)
    if shape is None or shape[1:] != tail or rows.stop > shape[0] or data.dtype.kind != "f":
        raise InputError(
            f"{checked.where(group)}/{name}: got {shape}, "
            f"allowed: real numbers of shape {(rows.stop, *tail)} and longer"
        )
    values: Array = data[rows].astype(float)
    if not np.isfinite(values).all():
        particle = int(np.argwhere(~np.isfinite(values))[0][0])
        raise InputError(
            f"{checked.where(data)}: row {rows.start + particle}: "
            f"got {values[particle]}, allowed: finite"
        )
    return values


@dataclass
class Frame:
    """The particles at one time; N of them."""

    time: float
    x: Array  # (N,3) m
    v: Array  # (N,3) m/s
    m: Array  # (N,) kg
    volume: Array  # (N,) m³
    J_P: Array  # (N,) det F_P


@dataclass
class Trajectory:
    """A file without its particles; frame() reads those."""

    path: Path
    times: Array  # of the frames [s]
    facts: dict[str, str] = field(default_factory=dict)  # attributes of /firn
    scene: Json = field(default_factory=dict)  # the resolved TOML
    scene_text: str = ""  # the same as text
    diagnostics: dict[str, Array] = field(default_factory=dict)  # by name, one row per step
    units: dict[str, str] = field(default_factory=dict)  # by name
    particles: int = 0

    @property
    def steps(self) -> int:
        """Rows with Δt > 0: a row of the initial state is no step."""
        return int(np.count_nonzero(self.diagnostics["dt"] > 0))

    def frame(self, index: int) -> Frame:
        """Reads one frame; negative indices count from the end."""
        index = range(len(self.times))[index]
        with h5py.File(self.path) as file:
            vtk = file["VTKHDF"]
            first = int(vtk["Steps/PointOffsets"][index])
            count = int(vtk["NumberOfPoints"][_part(vtk, index)])
            rows = slice(first, first + count)
            data = vtk["PointData"]
            F_P = particle_rows(data, "F_P", rows, 9).reshape(-1, 3, 3)
            return Frame(
                float(self.times[index]),
                particle_rows(vtk, "Points", rows, 3),
                particle_rows(data, "velocity", rows, 3),
                particle_rows(data, "mass", rows, 1),
                particle_rows(data, "volume", rows, 1),
                np.linalg.det(F_P),
            )


def _part(vtk: h5py.Group, index: int) -> int:
    offsets = vtk.get("Steps/PartOffsets")
    return int(offsets[index]) if offsets is not None else index


def read(path: str | Path) -> Trajectory:
    """Reads everything but the particles, which frame() fetches one frame at a time."""
    path = Path(path)
    with h5py.File(path) as file:
        try:
            firn, vtk = file["firn"], file["VTKHDF"]
            # An interrupted file has longer arrays: NSteps and `rows` count what is valid.
            frames = int(vtk["Steps"].attrs["NSteps"])
            table = firn["diagnostics"]
            rows = int(table.attrs["rows"])
            trajectory = Trajectory(path, checked.numbers(vtk, "Steps/Values", [None])[:frames])
            for name in DIAGNOSTICS:
                shape: list[int | None] = [None, 3] if name in VECTORS else [None]
                trajectory.diagnostics[name] = finite_rows(table, name, shape, rows)
                trajectory.units[name] = text_attribute(table[name], "units")
            if len(trajectory.times) < frames:
                raise InputError(
                    f"{path}: /VTKHDF/Steps: attribute NSteps: got {frames}, "
                    f"allowed: at most {len(trajectory.times)}, the length of Values"
                )
            if frames < 1:
                raise InputError(
                    f"{path}: /VTKHDF/Steps/NSteps: got {frames}, allowed: at least 1 frame"
                )
            trajectory.particles = int(vtk["NumberOfPoints"][_part(vtk, 0)])
        except (KeyError, ValueError, TypeError, AttributeError) as error:
            raise InputError(f"{path}: not a complete trajectory: {error.args[0]}") from None
        trajectory.facts = {
            name: text_attribute(firn, name) for name in firn.attrs if name != "scene"
        }
        scene = text_attribute(firn, "scene")
    try:
        trajectory.scene_text, trajectory.scene = scene, tomllib.loads(scene)
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{path}: /firn scene: not TOML: {error}") from None
    return trajectory
