# SPDX-License-Identifier: BSD-3-Clause
"""A results file of synthetic cases."""

import h5py
import numpy as np

from .cases import synthetic_cases


def write_results(path, slow=(), status=(), noise=0.01, verify="VALID", cases=None):
    """Results whose medians are known. `slow`: {case name: factor on its times};
    `status`: {case name: status}; `noise`: relative half-width of the repetitions."""
    slow, status = dict(slow), dict(status)
    text = h5py.string_dtype()
    with h5py.File(path, "w") as file:
        file.attrs.update({"format": "firn-results", "version": 1.0, "firn_version": "0.1.0"})
        file.create_group("sessions/0").attrs.update(
            {
                "processor": "synthetic",
                "processors": 2.0,
                "git_commit": "abc",
                "started": "2026-01-01T00:00:00Z",
            }
        )
        for i, case in enumerate(synthetic_cases() if cases is None else cases):
            group = file.create_group(f"cases/{case['suite']}/{case['name']}")
            state = status.get(case["name"], case["status"])
            group.attrs.update(
                {
                    "title": case["name"],
                    "command": f"firn bench '{case['suite']}/{case['name']}'",
                    "status": state,
                    "message": "" if state == "measured" else f"made {state}",
                    "validation": "synthetic",
                    "session": 0.0,
                    "wall_seconds": 1.5,
                    "processor_seconds": 1.25,
                }
            )
            group.create_group("parameters").attrs.update(
                {
                    k: float(v) if isinstance(v, (int, float)) else v
                    for k, v in case["parameters"].items()
                }
            )
            group.create_group("quantities")
            for name, (median, units, better, timed) in (
                {} if state in ("invalid", "failed") else case["quantities"]
            ).items():
                factor = slow.get(case["name"], 1.0) if timed else 1.0
                value = median * factor if better == "lower" else median / factor
                values = value * (1 + noise * np.linspace(-1, 1, 9)) if timed else [value]
                data = group.create_dataset(f"quantities/{name}", data=values)
                data.attrs.update(
                    {"units": units, "meaning": name, "better": better, "timed": float(timed)}
                )
            group["calibration"] = 2e-3 * (1 + 0.02 * np.random.default_rng(i).standard_normal(6))
        if verify:
            group = file.create_group("verify/optimized, float")
            group.attrs.update(
                {"verdict": verify, "command": "firn verify --solver optimized", "session": 0.0}
            )
            errors = [0.3, 0.01, 0.7 if verify == "VALID" else 12.0]
            columns = {
                "topic": ["kernel", "kernel", "conservation"],
                "check": ["sum of weights", "gradients", "momentum"],
                "verdict": ["VALID" if e <= 1 else "INVALID" for e in errors],
                "command": ["firn verify --filter x"] * 3,
            }
            for name, values in columns.items():
                group.create_dataset(name, data=values, dtype=text)
            group["error"] = errors
            mutants = file.create_group("mutants")
            mutants.attrs["command"] = "firn verify --mutants"
            for name, values in {
                "name": ["sign", "transpose"],
                "patch": ["f", "F"],
                "stage": ["grid_forces"] * 2,
                "named_stage": ["grid_forces"] * 2,
                "caught_by": ["momentum"] * 2,
            }.items():
                mutants.create_dataset(name, data=values, dtype=text)
            mutants["caught"] = [1.0, 1.0]
    return path
