# SPDX-License-Identifier: BSD-3-Clause
"""What `firn check --json` prints."""

from firn_reports.scene_hash import scene_hash


def check(verdict="VALID", scene_text="", missing=()):
    """What `firn check --json` prints, for two fields of one stage."""

    def field(name, bounds):
        return {
            "from": "rasterize",
            "through": "rasterize",
            "written_by": "rasterize",
            "field": name,
            "units": "kg",
            "compared": 812,
            "non_finite": 0,
            "largest_absolute": 1e-17,
            "rms_absolute": 1e-18,
            "largest_relative": 2e-16,
            "rms_relative": 1e-16,
            "largest_in_bounds": bounds,
            "rms_in_bounds": bounds / 5,
            "verdict": "VALID" if bounds <= 1 else "INVALID",
            "worst": {
                "step": 3,
                "node": [1, 2, 3],
                "index": 17,
                "component": 0,
                "reference": 0.5,
                "subject": 0.5,
                "bound": 1e-16,
            },
        }

    worst = 0.2 if verdict == "VALID" else 40.0
    return {
        "schema": "firn-check",
        "version": 2,
        "command": "firn check synthetic --steps 5",
        "git_commit": "abc",
        "scene": "synthetic",
        "scene_hash": scene_hash(scene_text),
        "windows": [{"start_step": 0, "steps": 2}, {"start_step": 70, "steps": 3}],
        "not_exercised": [{"key": m, "what": m, "shown_by": [m]} for m in missing],
        "exercised": [
            {"key": "light_node", "stage": "rasterize", "of": "nodes", "what": "light", "count": 7}
        ],
        "reference": "reference",
        "subject": "synthetic",
        "precision": "double",
        "mode": "lockstep",
        "steps": 5,
        "particles": 3000,
        "compared": 1624,
        "largest_in_bounds": worst,
        "verdict": verdict,
        "first_divergence": None
        if verdict == "VALID"
        else {
            "step": 3,
            "from": "rasterize",
            "through": "rasterize",
            "field": "node_velocity",
            "message": "node (1, 2, 3) diverges in rasterize",
        },
        "fields": [field("node_mass", 0.1), field("node_velocity", worst)],
        "properties": [{"name": "momentum", "compared": 5, "verdict": "VALID", "detail": "exact"}],
    }
