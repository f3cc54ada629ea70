"""Which page has what, and writing them: each is one HTML file that needs nothing else."""

import itertools
from collections.abc import Callable
from dataclasses import dataclass, field
from importlib import resources
from pathlib import Path
from typing import Any

import jinja2
import numpy as np
from numpy.typing import ArrayLike

from firn_reports import page as reports
from firn_reports.kinds import Array, Json

from . import (
    STAGES,
    by_hand,
    exercises,
    interactive,
    lesson as lesson_file,
    mathml,
    measured,
    pictures,
    source,
)
from .lesson import Lesson

STAGE_FILES = [f"{n:02d}_{name}.html" for n, name in enumerate(STAGES, 1)]
EXTRAS = ["svd", "semi_implicit", "optimized", "exercises", "interactive"]
REPRODUCES = "Shortest decimals that read back as the same double."


@dataclass
class Chapter:
    """One file of chapters/: title, lead, then the text, then what the optimized solver does."""

    name: str  # of the page
    title: str = ""
    lead: str = ""
    short: str = ""  # title for navigation
    text: str = ""
    optimized: str = ""
    stage: int = 0
    previous: tuple[str, str] | None = None  # (page, title)
    next: tuple[str, str] | None = None


@dataclass
class Section(reports.Section):
    """A section of a report that may also show source files."""

    sources: list[source.File] = field(default_factory=list)


def chapter(file: str, page: str) -> Chapter:
    """The text of a chapter for a page.

    Raises KeyError if its head names no title or lead.
    """
    head, *parts = (
        resources.files("firn_teach")
        .joinpath("chapters", file)
        .read_text(encoding="utf-8")
        .split("---\n")
    )
    facts = dict(line.split(": ", 1) for line in head.strip().splitlines())
    texts = [mathml.render(part) for part in parts] + ["", ""]
    return Chapter(
        page, facts["title"], facts["lead"], facts.get("short", facts["title"]), texts[0], texts[1]
    )


def chapters() -> list[Chapter]:
    """All pages but the index, in reading order, each with its neighbours."""
    pages = []
    for n, name in enumerate(STAGE_FILES, 1):
        pages.append(chapter(f"{n:02d}.html", name))
        pages[-1].stage = n
    pages += [chapter(f"{name}.html", f"{name}.html") for name in EXTRAS]
    for a, b in itertools.pairwise(pages):
        a.next, b.previous = (b.name, b.short), (a.name, a.short)
    pages[0].previous = ("index.html", "Overview")
    return pages


def components(value: ArrayLike) -> list[tuple[str, float]]:
    """Return a scalar, vector or matrix as (name, number): "", "x", or row and column."""
    value = np.atleast_1d(value)
    if value.shape == (3,):
        return list(zip("xyz", value, strict=True))
    if value.shape == (3, 3):
        return [(f"{r + 1}{c + 1}", value[r, c]) for r in range(3) for c in range(3)]
    return [("", value[0])]


def number_rows(lesson: Lesson, stage: int, of_node: bool) -> list[Json]:
    """The fields that a stage writes, before and after, for the chosen node or particle."""
    record, rows = lesson.record_of(stage), []
    index = lesson.i if of_node else lesson.p
    for name in record.written.get(STAGES[stage - 1], []):
        if (name in lesson_file.NODE_FIELDS) != of_node or not record.has(stage, name):
            continue
        after = components(getattr(record.at(stage), name)[index])
        before: list[tuple[str, float | None]] = [("", None)] * len(after)
        if record.has(stage - 1, name):
            before[:] = components(getattr(record.at(stage - 1), name)[index])
        label = (LABELS | {"V_p0": "V_p0 (0: not known yet)"}).get(name, name)
        rows.append(
            {
                "field": name,
                "label": label,
                "units": lesson_file.UNITS[name],
                "components": [
                    (c, "–" if b is None else repr(float(b)), repr(float(a)))
                    for (c, a), (_, b) in zip(after, before, strict=True)
                ],
            }
        )
    return rows


# What each stage reads besides what it changes: of the particle, of the node.
READS = {
    1: (["m_p", "x_p", "v_p"], []),
    2: (["m_p", "x_p"], ["m_i"]),
    3: (["V_p0", "F_E", "F_P"], ["m_i"]),
    4: ([], ["m_i", "v_i", "f_i"]),
    5: ([], ["m_i"]),
    6: (["F_E", "F_P"], ["v_i_star"]),
    7: (["x_p"], ["v_i_new"]),
    8: ([], ["v_i", "v_i_new"]),
    9: (["x_p"], []),
    10: (["v_p"], []),
}
LABELS = {"v_i_star": "v_i*", "v_i_new": "v_i at n+1"}


def read_rows(lesson: Lesson, stage: int) -> list[tuple[str, str, str, list[tuple[str, str]]]]:
    """Inputs as they stand before the stage, and the pair's own weight.

    Rows (owner, label, units, components).
    """
    record, rows = lesson.record_of(stage), []
    own_nodes = stage != 2  # the chosen node belongs to the step shown on the other pages
    for of_node, names in enumerate(READS[stage]):
        for name in names:
            if of_node and not own_nodes:
                continue
            value = getattr(record.at(stage - 1), name)[lesson.i if of_node else lesson.p]
            rows.append(
                (
                    lesson.node_name if of_node else lesson.particle_name,
                    LABELS.get(name, name),
                    lesson_file.UNITS[name],
                    [(c, repr(float(x))) for c, x in components(value)],
                )
            )
    pair = next((n for n in lesson.data["stencil"] if n["node"] == lesson.i), None)
    if pair and stage in (1, 3, 7, 8):
        rows.append(("both", "w_ip", "1", [("", repr(pair["w_ip"]))]))
    if pair and stage in (3, 7):
        rows.append(
            ("both", "∇w_ip", "1/m", list(zip("xyz", map(repr, pair["grad_w_ip"]), strict=True)))
        )
    return rows


def check_rows(lesson: Lesson, stage: int) -> list[Json]:
    """What the check found for the fields that this stage wrote."""
    rows = []
    for check in lesson.checks:
        kind = " semi-implicit" if check["semi_implicit"] else ""
        for row in check["fields"]:
            if (
                row["written_by"] == STAGES[stage - 1]
                and row["from"] == row["through"] == STAGES[stage - 1]
                and row["compared"]
            ):
                rows.append(
                    {
                        **row,
                        "precision": check["precision"] + kind,
                        "kind": "good" if row["verdict"] == "VALID" else "bad",
                    }
                )
    return rows


def check_command(lesson: Lesson) -> str:
    """What repeats the check of the lesson's step."""
    return f"firn check {lesson.argument} --start-step {lesson.record.step} --steps 1 --precision double"


def stage_values(lesson: Lesson, page: Chapter) -> Json:
    """What the template of a stage shows."""
    stage = page.stage
    record = lesson.record_of(stage)
    hand = by_hand.run(lesson, stage)
    line = (
        f"{lesson.scene.name}, step {record.step}, t = {record.time:.6g} s, Δt = {record.dt:.6g} s. "
        + (
            "This stage acts in the first step only, so this page shows that one."
            if stage == 2
            else f"{lesson.particle_name.capitalize()} and {lesson.node_name} are marked."
        )
    )
    code = by_hand.code(stage)
    if stage == 1:
        code = by_hand.helpers() + "\n\n" + code
    return {
        "scene_line": line,
        "pictures": pictures.of_stage(lesson, stage, STAGES[stage - 1]),
        "node_name": lesson.node_name.capitalize(),
        "particle_name": lesson.particle_name.capitalize(),
        "node_rows": number_rows(lesson, stage, True),
        "particle_rows": number_rows(lesson, stage, False),
        "reads": read_rows(lesson, stage),
        "hand_code": source.highlight(code, source.PYTHON),
        "hand_rows": [(f, f"{d:.2g}", f"{d * 2**52:.2g}") for f, _, _, d in hand],
        "source": source.File(lesson, source.path_of(stage)),
        "text": page.text,
        "optimized": page.optimized,
        "checks": check_rows(lesson, stage),
        "check_command": check_command(lesson),
    }


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
            figures=[pictures.implicit_energy(lesson)],
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


def balance(lesson: Lesson) -> list[tuple[str, str, str]]:
    """(quantity, before, after) of the whole scene."""
    b, a = lesson.data["diagnostics"]["before"], lesson.data["diagnostics"]["after"]
    rows = [("mass [kg]", repr(b["mass"]), repr(a["mass"]))]
    rows += [
        (f"momentum {c} [kg m/s]", repr(b["momentum"][k]), repr(a["momentum"][k]))
        for k, c in enumerate("xyz")
    ]
    rows += [
        (f"{name.replace('_', ' ')} [J]", repr(b[name]), repr(a[name]))
        for name in ("kinetic_energy", "elastic_energy", "gravitational_energy")
    ]
    return rows


def clause(sentence: str) -> str:
    """For use after a colon."""
    return sentence[0].lower() + sentence[1:].rstrip(".")


def index_values(lesson: Lesson, pages: list[Chapter]) -> Json:
    """What the overview shows."""
    record = lesson.record
    return {
        "scene_name": lesson.scene.name,
        "particles": len(record.id),
        "nodes": len(record.nodes),
        "h": lesson.scene.h,
        "step": record.step,
        "time": f"{record.time:.6g}",
        "dt": f"{record.dt:.6g}",
        "events": record.events,
        "particle_name": lesson.particle_name,
        "node_name": lesson.node_name,
        "why_step": lesson.why["step"],
        "why_particle": clause(lesson.why["particle"]),
        "why_node": clause(lesson.why["node"]),
        "extras": pages[len(STAGES) :],
        "balance": balance(lesson),
    }


def exercise_values(lesson: Lesson, program: str) -> Json:
    """What the page of exercises shows; runs every command for its answer."""
    bugs = exercises.bugs(lesson)
    commands = [bug["command"] + " --json" for bug in bugs] + exercises.parameter_commands()
    results = measured.run_all(commands, program)
    for bug, result in zip(bugs, results[: len(bugs)], strict=True):
        bug["message"] = (result.get("first_divergence") or {}).get("message", "nothing")
    return {"bugs": bugs, "parameters": exercises.parameters(results[len(bugs) :])}


def environment() -> jinja2.Environment:
    """Jinja2 for the templates of a lesson, with the style sheet of all pages."""
    result = reports.environment("firn_teach")
    own = resources.files("firn_teach").joinpath("templates/lesson.css").read_text("utf-8")
    result.globals["css"] = reports.style_sheet() + own
    return result


def write(lesson: Lesson, directory: str | Path, web_module: str = "") -> Path:
    """All pages into the folder; returns the path of the first."""
    directory, env, pages = Path(directory), environment(), chapters()
    directory.mkdir(parents=True, exist_ok=True)
    firn = lesson.data["firn"]
    env.globals |= {
        "stages": pages[: len(STAGES)],
        "site": [("index.html", "Overview")] + [(p.name, p.short) for p in pages[len(STAGES) :]],
        "footer": f"firn teach {lesson.argument}, firn {firn['version']}, {firn['processor']}",
    }
    index = Chapter(
        "index.html",
        "One time step of snow",
        f"{lesson.scene.name}: the ten stages on real numbers.",
        next=(pages[0].name, pages[0].title),
    )
    values: dict[str, tuple[str, Callable[[Chapter], Json]]] = {
        "svd.html": ("extra", lambda p: {"text": p.text, "sections": svd_sections(lesson)}),
        "semi_implicit.html": (
            "extra",
            lambda p: {"text": p.text, "sections": implicit_sections(lesson)},
        ),
        "optimized.html": (
            "extra",
            lambda p: {"text": p.text, "sections": optimized_sections(lesson, pages)},
        ),
        "exercises.html": (
            "exercises",
            lambda p: {"text": p.text} | exercise_values(lesson, firn["program"]),
        ),
        "interactive.html": ("interactive", lambda p: interactive.values(web_module)),
        "index.html": ("index", lambda p: index_values(lesson, pages)),
    }
    for page in [index, *pages]:
        template, make = values.get(page.name, ("stage", lambda p: stage_values(lesson, p)))
        html = env.get_template(f"{template}.html.jinja").render(page=page, **make(page))
        (directory / page.name).write_text(html, encoding="utf-8")
    return directory / "index.html"
