# SPDX-License-Identifier: BSD-3-Clause
"""The pages beside the stages: decomposition, semi-implicit step, optimized solver."""

from typing import Any

import numpy as np

from firn_reports import page as reports
from firn_reports.kinds import Array, Json

from . import grid_pictures, source
from .chapter import Chapter, Section
from .lesson import Lesson

REPRODUCES = "Shortest decimals that read back as the same double."


def matrix_rows(name: str, matrix: Array) -> list[list[str]]:
    """The rows of a matrix (3, 3), the first with its name."""
    return [
        [name if r == 1 else ""] + [repr(float(x)) for x in row] for r, row in enumerate(matrix)
    ]


def table(columns: list[str], rows: list[list[Any]], title: str = "") -> reports.Table:
    """A table without a CSV file."""
    return reports.Table("", title, columns, rows)


def svd_sections(lesson: Lesson) -> list[Section]:
    """The decomposition of the chosen particle's F_E."""
    d = {k: np.array(v) for k, v in lesson.data["decomposition"].items()}
    F, eps = d["F_E_hat"], 2.0**-52
    numbers = [
        row
        for name, key in (
            ("∇v_p [1/s]", "grad_v_p"),
            ("F̂_E", "F_E_hat"),
            ("U", "U"),
            ("V", "V"),
            ("R", "R"),
            ("S", "S"),
        )
        for row in matrix_rows(name, d[key])
    ]
    numbers.insert(6, ["Σ̂"] + [repr(float(x)) for x in d["sigma"]])
    again = np.linalg.norm(d["U"] @ np.diag(d["sigma"]) @ d["V"].T - F) / np.linalg.norm(F)
    proofs = [
        ["‖U Σ̂ Vᵀ − F̂_E‖ / ‖F̂_E‖", again / eps],
        ["‖UᵀU − I‖", np.linalg.norm(d["U"].T @ d["U"] - np.eye(3)) / eps],
        ["det U − 1", (np.linalg.det(d["U"]) - 1) / eps],
        ["det V − 1", (np.linalg.det(d["V"]) - 1) / eps],
        ["‖R S − F̂_E‖ / ‖F̂_E‖", np.linalg.norm(d["R"] @ d["S"] - F) / np.linalg.norm(F) / eps],
        ["‖S − Sᵀ‖", np.linalg.norm(d["S"] - d["S"].T) / eps],
    ]
    return [
        Section(
            "numbers",
            f"{lesson.particle_name.capitalize()}, by the reference's own code",
            "From stage 7 of this lesson's step. " + REPRODUCES,
            tables=[
                table(["", "", "", ""], numbers),
                table(
                    ["in exact arithmetic 0", "here, in units of 2⁻⁵²"], proofs, "What must hold"
                ),
            ],
        ),
        Section(
            "sweeps",
            "The same matrix, sweep by sweep",
            "One-sided Jacobi in NumPy on F̂_E: the largest cosine between two columns after each sweep. Each sweep squares it, until roundoff is reached.",
            tables=[table(["sweep", "largest cosine", "lengths of the columns"], jacobi(F))],
        ),
        Section(
            "source",
            "The reference's source",
            sources=[
                source.File(lesson, f"reference/{name}")
                for name in ("svd.hpp", "svd.cpp", "polar.hpp")
            ],
        ),
    ]


def jacobi(F: Array) -> list[list[Any]]:
    """Rows: sweep, largest cosine between columns, their lengths."""
    B, rows = F.copy(), []
    for sweep in range(8):
        cosine = max(
            abs(B[:, p] @ B[:, q]) / (np.linalg.norm(B[:, p]) * np.linalg.norm(B[:, q]))
            for p, q in ((0, 1), (0, 2), (1, 2))
        )
        rows.append(
            [sweep, float(cosine), ", ".join(f"{x:.10g}" for x in np.linalg.norm(B, axis=0))]
        )
        if cosine < 2.0**-52:
            break
        for p, q in ((0, 1), (0, 2), (1, 2)):
            angle = 0.5 * np.arctan2(2 * B[:, p] @ B[:, q], B[:, p] @ B[:, p] - B[:, q] @ B[:, q])
            c, s = np.cos(angle), np.sin(angle)
            B[:, [p, q]] = B[:, [p, q]] @ np.array([[c, -s], [s, c]])
    return rows


def implicit_sections(lesson: Lesson) -> list[Section]:
    """Longer and longer steps, and the check of a semi-implicit step."""

    def energy(t: Json, which: str) -> float | str:
        """Kinetic and elastic energy [J], or "failed"."""
        if t[f"{which}_error"]:
            return "failed"
        return sum(float(t[which][k]) for k in ("kinetic_energy", "elastic_energy"))

    rows = []
    for t in lesson.data["implicit_trials"]:
        rows.append(
            [
                int(t["multiple"]),
                t["dt"],
                t["steps"],
                energy(t, "explicit"),
                energy(t, "semi_implicit"),
                t["iterations"],
                float(t["residual"]),
                "yes" if t["indefinite"] else "no",
            ]
        )
    errors = sorted(
        {
            t[f"{w}_error"]
            for t in lesson.data["implicit_trials"]
            for w in ("explicit", "semi_implicit")
        }
        - {""}
    )
    intro = "The same stretch of time from the state of this lesson, in longer and longer steps: the energy at its end, and the iterations of the first solve."
    columns = [
        "Δt, multiple",
        "Δt [s]",
        "steps",
        "explicit: energy [J]",
        "semi-implicit: energy [J]",
        "iterations",
        "true relative residual",
        "negative curvature",
    ]
    sections = [
        Section(
            "measured",
            "Measured on this scene",
            intro + (" Failures: " + "; ".join(errors) + "." if errors else ""),
            figures=[grid_pictures.implicit_energy(lesson)],
            tables=[table(columns, rows)],
        )
    ]
    implicit = [check for check in lesson.checks if check["semi_implicit"]]
    if implicit:
        found = [
            [
                c["precision"],
                p["name"],
                p["compared"],
                reports.Mark(p["verdict"], "good" if p["verdict"] == "VALID" else "bad"),
            ]
            for c in implicit
            for p in c["properties"]
        ]
        sections.append(
            Section(
                "check",
                "The optimized solver on the same system",
                "Checked on this step with the integrator replaced.",
                tables=[table(["precision", "property", "numbers", "verdict"], found)],
            )
        )
    files = (
        "step_06_integration.cpp",
        "implicit_system.hpp",
        "implicit_system.cpp",
        "minres.cpp",
        "transfer.cpp",
        "constitutive.cpp",
    )
    return [
        *sections,
        Section(
            "source",
            "The reference's source",
            sources=[source.File(lesson, f"reference/{name}") for name in files],
        ),
    ]


def optimized_sections(lesson: Lesson, pages: list[Chapter]) -> list[Section]:
    """What the check of the optimized solver found, field by field."""
    sections = []
    for check in lesson.checks:
        kind = ", semi-implicit" if check["semi_implicit"] else ""
        rows = [
            [
                f["through"] if f["from"] == f["through"] else f"{f['from']} … {f['through']}",
                f["field"],
                f["compared"],
                f["largest_absolute"],
                f["largest_in_bounds"],
                reports.Mark(f["verdict"], "good" if f["verdict"] == "VALID" else "bad"),
            ]
            for f in check["fields"]
            if f["written_by"]
        ]
        rows += [
            [
                p["name"],
                "",
                p["compared"],
                "",
                "",
                reports.Mark(p["verdict"], "good" if p["verdict"] == "VALID" else "bad"),
            ]
            for p in check["properties"]
        ]
        largest = max((float(f["largest_in_bounds"]) for f in check["fields"]), default=0)
        sections.append(
            Section(
                f"check-{check['precision']}{'-implicit' if kind else ''}",
                f"This step in {check['precision']} precision{kind}",
                f"{check['verdict']}: largest error {largest:.2g} of its bound.",
                tables=[
                    table(
                        [
                            "stage",
                            "field",
                            "numbers compared",
                            "largest error",
                            "in units of its bound",
                            "verdict",
                        ],
                        rows,
                    )
                ],
                command=f"firn check {lesson.argument} --start-step {lesson.record.step} --steps 1 --precision {check['precision']}"
                if not kind
                else "",
            )
        )
    if not lesson.checks:
        sections.append(
            Section(
                "check",
                "This step",
                "The optimized solver does not support scenes of this kind, so there is nothing to compare here. Try firn teach tiny_impact.",
            )
        )
    return sections
