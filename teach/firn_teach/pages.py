# SPDX-License-Identifier: BSD-3-Clause
"""Which page has what, and writing them: each is one HTML file that needs nothing else."""

from collections.abc import Callable, Sequence
from importlib import resources
from pathlib import Path

import jinja2

from firn_reports import output, page as reports
from firn_reports.kinds import Json

from . import STAGES, by_hand, exercises, interactive, measured, pictures, source
from .chapter import Chapter, chapters
from .extras import implicit_sections, optimized_sections, svd_sections
from .lesson import Lesson
from .rows import check_rows, number_rows, read_rows


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
        "called": [source.File(lesson, path) for path in source.called_by(stage)],
        "text": page.text,
        "optimized": page.optimized,
        "checks": check_rows(lesson, stage),
        "check_command": check_command(lesson),
    }


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


def write(
    lesson: Lesson,
    directory: str | Path,
    web_module: str = "",
    inputs: Sequence[str | Path] = (),
    force: bool = False,
) -> Path:
    """All pages into the folder; returns the path of the first.

    Raises InputError if one of them is one of the inputs, or a file of others (see `force`).
    """
    directory, env, pages = Path(directory), environment(), chapters()
    output.require_free(directory, ["index.html", *(p.name for p in pages)], inputs, force)
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
