# SPDX-License-Identifier: BSD-3-Clause
"""A results file (format firn-results): measured cases, sessions, verifications, mutants.

docs/results_schema.md describes the format.
"""

import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from . import InputError, checked
from .kinds import Array, Json


@dataclass
class Quantity:
    """A measured quantity with every repetition."""

    name: str
    units: str
    meaning: str
    better: str
    timed: bool
    values: Array  # one per repetition

    @property
    def median(self) -> float:
        """Median of the repetitions, NaN if there is none."""
        return float(np.median(self.values)) if len(self.values) else float("nan")

    @property
    def quartiles(self) -> tuple[float, float]:
        """First and third quartile of the repetitions, NaN if there is none."""
        return (
            tuple(np.percentile(self.values, [25, 75])) if len(self.values) else (float("nan"),) * 2
        )

    @property
    def spread(self) -> float:
        """(third quartile − first) / median."""
        low, high = self.quartiles
        return float((high - low) / abs(self.median)) if self.median else 0.0


@dataclass
class Case:
    """A measured case: case[name] is a parameter of it, None if it has no such parameter."""

    suite: str
    name: str
    title: str
    command: str
    status: str
    message: str
    validation: str
    session: int
    parameters: Json
    quantities: dict[str, Quantity]
    calibration: Array  # times of the fixed loop around the measurement [s]
    wall_seconds: float | None = None  # what measuring it took, validation included
    processor_seconds: float | None = None
    finished: str = ""  # UTC

    @property
    def quotable(self) -> bool:
        """True if the numbers of the case may be shown."""
        return self.status == "measured"

    def value(self, name: str) -> float | None:
        """Median of a quantity that may be quoted, else None."""
        return self.quantities[name].median if self.quotable and name in self.quantities else None

    def median(self, name: str) -> float:
        """The same, but NaN instead of None: a gap in a line."""
        value = self.value(name)
        return math.nan if value is None else value

    def __getitem__(self, parameter: str) -> Any:
        return self.parameters.get(parameter)


@dataclass
class Results:
    """What a results file holds."""

    path: Path
    firn_version: str = ""
    sessions: list[Json] = field(default_factory=list)  # facts of the machine
    cases: list[Case] = field(default_factory=list)
    verify: dict[str, Json] = field(default_factory=dict)  # by subject: {verdict, command, rows}
    mutants: Json = field(default_factory=dict)  # {command, rows}

    def subjects(self) -> set[tuple[str, str]]:
        """Solver and precision of every case that has them."""
        return {
            (str(case["solver"]), str(case["precision"]))
            for case in self.cases
            if case["solver"] is not None and case["precision"] is not None
        }

    def suite(self, name: str) -> list[Case]:
        """The cases of a suite."""
        return [case for case in self.cases if case.suite == name]

    def find(self, suite: str, name: str) -> Case | None:
        """The case of this name, None if there is none."""
        return next((c for c in self.cases if c.suite == suite and c.name == name), None)


def plain(value: Any) -> Any:
    """HDF5 attribute or element as str, int or float."""
    if isinstance(value, bytes):
        return value.decode("utf-8", "replace")
    if isinstance(value, (float, np.floating)):
        exact = float(value)
        return int(exact) if exact.is_integer() and abs(exact) < 2**53 else exact
    return value.item() if hasattr(value, "item") else value


def attributes(node: h5py.HLObject) -> Json:
    """All attributes of a group or data set, by name."""
    return {key: plain(value) for key, value in node.attrs.items()}


# What older files call a quantity, by suite, and what it is called now.
RENAMED = {("targets", "FMA peak"): "FMA peak, factored count"}


STATUSES = ("measured", "noisy", "invalid", "failed")


def flaw(quantity: Quantity) -> str:
    """What is wrong with the repetitions of a quantity that has a better and a worse; else ""."""
    if quantity.better == "neither":
        return ""
    if quantity.timed and not len(quantity.values):
        return f"{quantity.name}: no repetitions"
    for i, value in enumerate(quantity.values):
        if not math.isfinite(value) or (quantity.timed and value <= 0):
            return f"{quantity.name}: repetition {i} is {value:g}"
    return ""


def read_case(suite: str, name: str, group: h5py.Group) -> Case:
    """The case that an HDF5 group holds. Numbers that cannot be make it a failed one.

    Raises KeyError if a part is missing, InputError if one is not what it must be.
    """
    a = attributes(group)
    a["status"] = checked.text(group, "status", STATUSES)
    quantities = {}
    for stored_name, data in group["quantities"].items():
        q = attributes(data)
        key = RENAMED.get((suite, stored_name), stored_name)
        values = checked.numbers(group["quantities"], stored_name, [None], finite=False)
        quantities[key] = Quantity(
            key, q["units"], q["meaning"], q["better"], bool(q["timed"]), values
        )
        if a["status"] in ("measured", "noisy") and (wrong := flaw(quantities[key])):
            a["status"], a["message"] = "failed", wrong
    return Case(
        suite,
        name,
        a["title"],
        a["command"],
        a["status"],
        a["message"],
        a["validation"],
        int(a["session"]),
        attributes(group["parameters"]),
        quantities,
        checked.numbers(group, "calibration", [None]),
        a.get("wall_seconds"),
        a.get("processor_seconds"),
        a.get("finished", ""),
    )


def read_columns(group: h5py.Group, columns: list[str]) -> list[Json]:
    """The rows of a group that holds one data set per column.

    Raises ValueError if the columns differ in length.
    """
    return [
        dict(zip(columns, values, strict=True))
        for values in zip(
            *[[plain(v) for v in group[column][()]] for column in columns], strict=True
        )
    ]


def read(path: str | Path) -> Results:
    """The whole file.

    Raises InputError if it is no results file, OSError if it cannot be opened.
    """
    result = Results(Path(path))
    with h5py.File(path) as file:
        try:
            result.firn_version = attributes(file).get("firn_version", "")
            sessions = file.get("sessions", {})
            result.sessions = [attributes(sessions[key]) for key in sorted(sessions, key=int)]
            for suite, cases in file.get("cases", {}).items():
                result.cases += [read_case(suite, name, group) for name, group in cases.items()]
            for subject, group in file.get("verify", {}).items():
                result.verify[subject] = {
                    **attributes(group),
                    "rows": read_columns(group, ["topic", "check", "error", "verdict", "command"]),
                }
            if "mutants" in file:
                columns = ["name", "patch", "stage", "named_stage", "caught_by", "caught"]
                result.mutants = {
                    **attributes(file["mutants"]),
                    "rows": read_columns(file["mutants"], columns),
                }
        except (KeyError, ValueError, TypeError, AttributeError) as error:
            raise InputError(
                f"{path}: not a results file as docs/results_schema.md describes it: {error}"
            ) from None
    return result
