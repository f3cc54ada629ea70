# SPDX-License-Identifier: BSD-3-Clause
"""lesson.json as arrays: the state before the step, and each field as the stages wrote it."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
from numpy.typing import ArrayLike

from firn_reports import InputError, json_file
from firn_reports.kinds import Array, Json

from . import STAGES

NODE_FIELDS = {"m_i", "v_i", "f_i", "v_i_star", "free_directions", "v_i_new"}
UNITS = {
    "m_i": "kg",
    "v_i": "m/s",
    "f_i": "N",
    "v_i_star": "m/s",
    "v_i_new": "m/s",
    "V_p0": "m³",
    "free_directions": "1",
    "F_E": "1",
    "F_P": "1",
    "v_p": "m/s",
    "x_p": "m",
    "m_p": "kg",
}


class Record:
    """One step: `at(stage)` has every field as it stands after that stage.

    Stage 0 is before the step.
    """

    def __init__(self, data: Json) -> None:
        self.step, self.time, self.dt, self.dt_bound = (
            data["step"],
            data["time"],
            data["dt"],
            data["dt_bound"],
        )
        self.nodes = np.array(data["nodes"], dtype=int).reshape(-1, 3)
        self.events = data["events"]
        before = data["before"]
        self.id, self.material = np.array(before["id"]), np.array(before["material"])
        self.written = {name: list(fields) for name, fields in data["stages"].items() if fields}
        fields = {"m_p": array(before["m"])} | {
            name: array(before[name]) for name in ("x_p", "v_p", "V_p0", "F_E", "F_P")
        }
        self._states = [dict(fields)]
        for name in STAGES:
            for field, values in (data["stages"].get(name) or {}).items():
                if values:
                    fields[field] = array(values)
            self._states.append(dict(fields))

    def at(self, stage: int) -> SimpleNamespace:
        """Every field after the stage, by its symbol."""
        return SimpleNamespace(**self._states[stage])

    def has(self, stage: int, field: str) -> bool:
        """True if the field is known after the stage."""
        return field in self._states[stage]


class Lesson:
    """What lesson.json holds."""

    def __init__(self, data: Json) -> None:
        self.data = data
        self.scene = SimpleNamespace(**data["scene"])
        self.scene.gravity, self.scene.origin = array(self.scene.gravity), array(self.scene.origin)
        self.scene.period_nodes = np.array(self.scene.period_nodes)
        self.record, self.first = Record(data["record"]), Record(data["first"])
        self.p, self.i = data["particle"], data["node"]
        self.why, self.sources, self.checks = data["why"], data["sources"], data["checks"]
        self.argument = data["argument"]

    @property
    def particle_name(self) -> str:
        """The chosen particle in words."""
        return f"particle {self.record.id[self.p]}"

    @property
    def node_name(self) -> str:
        """The chosen node in words."""
        return f"node ({', '.join(str(n) for n in self.record.nodes[self.i])})"

    def record_of(self, stage: int) -> Record:
        """Stage 2 acts in the first step only: its page shows that one."""
        return self.first if stage == 2 else self.record

    def material(self, record: Record | None = None) -> SimpleNamespace:
        """One row of parameters per particle."""
        rows = [
            {
                **m,
                "critical_compression": float(m["critical_compression"]),
                "critical_stretch": float(m["critical_stretch"]),
            }
            for m in self.scene.materials
        ]
        keys = ("mu_0", "lambda_0", "hardening", "critical_compression", "critical_stretch")
        which = (record or self.record).material
        return SimpleNamespace(**{key: np.array([row[key] for row in rows])[which] for key in keys})


def array(values: ArrayLike) -> Array:
    """Numbers as an array of doubles."""
    return np.array(values, dtype=float)


def read(path: str | Path) -> Lesson:
    """The lesson of a file.

    Raises InputError if the file holds something else.
    """
    data = json_file.read(path)
    if (
        not isinstance(data, dict)
        or data.get("format") != "firn-lesson"
        or data.get("version") != 1
    ):
        raise InputError(
            f"{path}: format: allowed: firn-lesson, version 1, as `firn teach` writes it"
        )
    return Lesson(data)
