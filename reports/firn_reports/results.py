"""A results file (format firn-results): measured cases, sessions, verifications, mutants.

docs/results_schema.md describes the format.
"""

from dataclasses import dataclass, field
from pathlib import Path

import h5py
import numpy as np

from . import InputError


@dataclass
class Quantity:
    name: str
    units: str
    meaning: str
    better: str
    timed: bool
    values: np.ndarray

    @property
    def median(self):
        return float(np.median(self.values)) if len(self.values) else float("nan")

    @property
    def quartiles(self):
        return (
            tuple(np.percentile(self.values, [25, 75])) if len(self.values) else (float("nan"),) * 2
        )

    @property
    def spread(self):
        """(third quartile − first) / median."""
        low, high = self.quartiles
        return float((high - low) / abs(self.median)) if self.median else 0.0


@dataclass
class Case:
    suite: str
    name: str
    title: str
    command: str
    status: str
    message: str
    validation: str
    session: int
    parameters: dict
    quantities: dict
    calibration: np.ndarray
    wall_seconds: float = None  # what measuring it took, validation included
    processor_seconds: float = None
    finished: str = ""  # UTC

    @property
    def quotable(self):
        return self.status == "measured"

    def value(self, name):
        """Median of a quantity that may be quoted, else None."""
        return self.quantities[name].median if self.quotable and name in self.quantities else None

    def __getitem__(self, parameter):
        return self.parameters.get(parameter)


@dataclass
class Results:
    path: Path
    firn_version: str = ""
    sessions: list = field(default_factory=list)  # dicts of machine facts
    cases: list = field(default_factory=list)
    verify: dict = field(default_factory=dict)  # subject -> {verdict, command, rows}
    mutants: dict = field(default_factory=dict)  # {command, rows}

    def suite(self, name):
        return [case for case in self.cases if case.suite == name]

    def find(self, suite, name):
        return next((c for c in self.cases if c.suite == suite and c.name == name), None)


def plain(value):
    """HDF5 attribute or element as str, int or float."""
    if isinstance(value, bytes):
        return value.decode("utf-8", "replace")
    if isinstance(value, (float, np.floating)):
        return int(value) if float(value).is_integer() and abs(value) < 2**53 else float(value)
    return value.item() if hasattr(value, "item") else value


def attributes(node):
    return {key: plain(value) for key, value in node.attrs.items()}


# What older files call a quantity, by suite, and what it is called now.
RENAMED = {("targets", "FMA peak"): "FMA peak, factored count"}


def read_case(suite, name, group):
    a = attributes(group)
    quantities = {}
    for stored_name, data in group["quantities"].items():
        q = attributes(data)
        key = RENAMED.get((suite, stored_name), stored_name)
        quantities[key] = Quantity(
            key, q["units"], q["meaning"], q["better"], bool(q["timed"]), data[()].astype(float)
        )
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
        group["calibration"][()],
        a.get("wall_seconds"),
        a.get("processor_seconds"),
        a.get("finished", ""),
    )


def read_columns(group, columns):
    return [
        dict(zip(columns, values, strict=True))
        for values in zip(
            *[[plain(v) for v in group[column][()]] for column in columns], strict=True
        )
    ]


def read(path):
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
        except (KeyError, ValueError) as error:
            raise InputError(
                f"{path}: not a results file as docs/results_schema.md describes it: {error}"
            ) from None
    return result
