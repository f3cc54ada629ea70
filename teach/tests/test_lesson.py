# SPDX-License-Identifier: BSD-3-Clause
"""What the pages say, against what the program computes and what it was compiled from."""

import html
import itertools
import json
import re
import shlex
import subprocess
from concurrent.futures import ThreadPoolExecutor

import h5py
import numpy as np
import pytest

from firn_teach import STAGES, by_hand, chapter, exercises, lesson as lesson_file, mathml, pages

from conftest import BUILD, ROOT, firn

FILES = {"v_p": "velocity", "V_p0": "volume", "F_E": "F_E", "F_P": "F_P"}


def numbers(page, when):
    """data-field, data-component -> text, as the page prints it."""
    found = re.findall(
        rf'data-field="(\w+)" data-component="(\d+)" data-when="{when}">([^<]*)<', page
    )
    return {(field, int(component)): text for field, component, text in found}


def particle_after(lesson, steps, folder):
    """The chosen particle after so many steps, out of `firn run`'s file."""
    file = folder / f"{steps}.vtkhdf"
    done = firn(
        "run", "tiny_impact", "--solver", "reference", "--steps", steps, "-o", file, folder=folder
    )
    assert done.returncode == 0, done.stderr
    with h5py.File(file) as f:
        vtk = f["VTKHDF"]
        first = int(vtk["Steps/PointOffsets"][int(vtk["Steps"].attrs["NSteps"]) - 1])
        p = first + lesson.data["particle"]
        result = {name: np.ravel(vtk["PointData"][dataset][p]) for name, dataset in FILES.items()}
        return result | {"x_p": vtk["Points"][p]}


def test_made_in_time(lesson):
    assert lesson.seconds < 30  # the promise of `firn teach`


def test_numbers_are_those_of_firn_run(lesson, tmp_path):
    step = lesson.data["record"]["step"]
    before, after = (particle_after(lesson, step + k, tmp_path) for k in (0, 1))
    compared = 0
    # x_p, v_p, F_E, F_P: what the last stage that writes each of them leaves is what a run leaves.
    for stage, field in ((7, "F_E"), (7, "F_P"), (8, "v_p"), (9, "v_p"), (10, "x_p")):
        page = lesson.page(chapter.STAGE_FILES[stage - 1])
        if stage != 9:
            for (name, c), text in numbers(page, "before").items():
                if name == field:
                    assert float(text) == before[field][c], (stage, field, c)
                    compared += 1
        if stage != 8:
            for (name, c), text in numbers(page, "after").items():
                if name == field:
                    assert float(text) == after[field][c], (stage, field, c)
                    compared += 1
    assert compared == 2 * (9 + 9) + 3 + 3 + 2 * 3
    first = particle_after(lesson, 1, tmp_path)
    assert float(numbers(lesson.page("02_volumes.html"), "after")["V_p0", 0]) == first["V_p0"][0]


def test_every_stage_shows_the_node_or_the_particle(lesson):
    for name, fields in zip(
        chapter.STAGE_FILES,
        (
            ["m_i", "v_i"],
            ["V_p0"],
            ["f_i"],
            ["v_i_star"],
            ["v_i_star"],
            ["v_i_new"],
            ["F_E", "F_P"],
            ["v_p"],
            ["v_p"],
            ["x_p"],
        ),
        strict=True,
    ):
        assert {field for field, _ in numbers(lesson.page(name), "after")} == set(fields), name


def test_numpy_finds_the_same(lesson):
    read = lesson_file.read(lesson.folder / "lesson.json")
    rows = 0
    for stage in range(1, 11):
        for field, _, _, difference in by_hand.run(read, stage):
            # Sums of some 500 terms, after cancellation: a hundred units of roundoff is generous,
            # a wrong formula is not.
            assert difference < 100 * 2.0**-52, (stage, field)
            rows += 1
    assert rows == 12


def test_the_lesson_has_something_to_show(lesson):
    events = lesson.data["record"]["events"]
    assert events["nodes_in_contact"] > 0
    assert events["particles_yielding"] > 0
    for stage in (5, 7):
        page = lesson.page(chapter.STAGE_FILES[stage - 1])
        assert numbers(page, "before") != numbers(page, "after"), stage


def test_the_optimized_solver_is_checked_in_every_stage(lesson):
    for name in chapter.STAGE_FILES:
        found = re.findall(r"data-in-bounds>([^<]*)<", lesson.page(name))
        assert len(found) >= 2, name  # double and float
        assert all(float(value) <= 1 for value in found), (name, found)


# --- the source shown is the source compiled ------------------------------------------------


def shown_sources(lesson):
    sources = {}
    for page in sorted(lesson.folder.glob("*.html")):
        for path, text in re.findall(
            r'<pre class="source" tabindex="0" data-path="([^"]+)"><code>(.*?)</code></pre>',
            page.read_text(encoding="utf-8"),
            re.DOTALL,
        ):
            sources[path] = html.unescape(re.sub(r"</?span[^>]*>", "", text))
    return sources


def test_source_shown_is_the_file(lesson):
    sources = shown_sources(lesson)
    assert {f"reference/step_{n:02d}_{name}.cpp" for n, name in enumerate(STAGES, 1)} <= set(
        sources
    )
    for path, text in sources.items():
        assert text == (ROOT / path).read_text(encoding="utf-8"), path


def compile_again(command, text, folder):
    """The page's text through the build's own command: its object and the build's, as bytes."""
    words = shlex.split(command["command"])
    launcher = [n for n, word in enumerate(words) if word.endswith("ccache")]
    words = words[launcher[0] + 1 :] if launcher else words
    source = folder / command["file"].split("/")[-1]
    source.write_text(text, encoding="utf-8")
    built = BUILD / words[words.index("-o") + 1]
    words[words.index("-o") + 1] = str(folder / (source.name + ".o"))
    words[words.index("-c") + 1] = str(source)
    for option in ("-MT", "-MF"):
        if option in words:
            del words[words.index(option) : words.index(option) + 2]
    words = [word for word in words if word != "-MD"]
    subprocess.run(words, cwd=command["directory"], check=True, timeout=300)
    return (folder / (source.name + ".o")).read_bytes(), built.read_bytes()


def test_source_shown_compiles_to_the_very_object_that_was_linked(lesson, tmp_path):
    commands = {c["file"]: c for c in json.loads((BUILD / "compile_commands.json").read_text())}
    steps = {path: text for path, text in shown_sources(lesson).items() if "/step_" in path}
    if any("-g" in commands[str(ROOT / path)]["command"].split() for path in steps):
        pytest.skip("objects with debug symbols hold the name of their folder")
    with ThreadPoolExecutor(2) as pool:
        pairs = pool.map(
            lambda item: compile_again(commands[str(ROOT / item[0])], item[1], tmp_path),
            steps.items(),
        )
        for path, (again, built) in zip(steps, pairs, strict=True):
            assert again == built, path
    assert len(steps) == 10


def test_another_source_makes_another_object(lesson, tmp_path):
    command = {c["file"]: c for c in json.loads((BUILD / "compile_commands.json").read_text())}[
        str(ROOT / "reference/step_10_positions.cpp")
    ]
    again, built = compile_again(
        command,
        shown_sources(lesson)["reference/step_10_positions.cpp"].replace(
            "dt * particles.v", "2 * dt * particles.v"
        ),
        tmp_path,
    )
    assert again != built


# --- exercises ------------------------------------------------------------------------------


def test_every_exercise_is_found_in_its_stage(lesson):
    answers = re.findall(
        r'<p>The check says, stage <a href="[^"]+">(\w+)</a>: <code>([^<]*)</code>',
        lesson.page("exercises.html"),
    )
    assert len(answers) == len(lesson.data["exercises"]) == 12
    for (stage, message), exercise in zip(answers, lesson.data["exercises"], strict=True):
        assert stage == exercise["stage"], exercise
        assert "allowed difference" in message, exercise
    assert len({stage for stage, _ in answers}) >= 6


def test_an_exercise_does_not_give_itself_away(lesson, tmp_path):
    done = firn(*shlex.split(exercises.check_command(2, "tiny_impact"))[1:], folder=tmp_path)
    assert done.returncode == 1
    assert "exercise:2" in done.stdout
    assert lesson.data["exercises"][1]["mutant"] not in done.stdout
    visible = re.sub(r"<details>.*?</details>", "", lesson.page("exercises.html"), flags=re.DOTALL)
    assert not any(exercise["mutant"] in visible for exercise in lesson.data["exercises"])


def test_commands_of_parameters_show_what_the_answers_say(lesson):
    page = lesson.page("exercises.html")
    tables = [
        [
            re.findall(r"<td[^>]*>([^<]*)<", row)
            for row in re.findall(r"<tr>(<td.*?)</tr>", body, re.DOTALL)
        ]
        for body in re.findall(r"<tbody>(.*?)</tbody>", page, re.DOTALL)
    ]
    by_id = {task["id"]: rows for task, rows in zip(exercises.PARAMETERS, tables, strict=True)}
    assert len(tables) == len(exercises.PARAMETERS) == 6

    def column(task, k):
        return [row[k] for row in by_id[task]]

    def falls(values):
        return all(float(a) > float(b) for a, b in itertools.pairwise(values))

    speeds = [float(s) for s in column("alpha", 1)]
    assert max(speeds[:3]) < 1 < speeds[3]  # one piece, then bursts
    assert falls(column("xi", 1)[::-1])  # higher with more hardening
    assert falls(column("theta-c", 1)[::-1])  # more is given back
    assert falls(column("theta-s", 2)[::-1])  # more elastic energy is held
    assert column("dt", 1) == ["completed"] * 3 + ["failed"]
    assert column("beta", 1) == ["failed"] + ["completed"] * 3
    assert falls(column("beta", 2))


def test_unknown_exercise(tmp_path):
    done = firn("check", "tiny_impact", "--solver", "exercise:13", folder=tmp_path)
    assert done.returncode == 2
    assert "exercise:1 .. exercise:12" in done.stderr


# --- options --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--particle", "9999"], "--particle: id: got 9999"),
        (["--node", "1,2"], "--node: i,j,k: got 1,2"),
        (["--node", "99,0,0"], "--node"),
        (["--step", "-1"], "--step: step to show: got -1"),
        (["no_such_scene"], "no_such_scene"),
    ],
)
def test_bad_input(words, message, tmp_path):
    done = firn("teach", *words, "-o", tmp_path / "out", folder=tmp_path)
    assert done.returncode == 2
    assert message in done.stderr
    assert done.stderr.count("\n") == 1
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("scene", "words"),
    [
        ("two_particles", []),
        ("implicit.toml", ["--step", "3", "--particle", "7"]),
        ("periodic.toml", ["--step", "1"]),
    ],
)
def test_other_scenes(scene, words, tmp_path, monkeypatch):
    text = firn("scenes", "--show", "tiny_impact", folder=tmp_path).stdout
    implicit = 'type = "semi-implicit"\nimplicitness = 1.0\ntolerance = 1e-8\nmax_iterations = 500'
    (tmp_path / "implicit.toml").write_text(text.replace('type = "explicit"', implicit))
    (tmp_path / "periodic.toml").write_text(
        text.replace("spacing = 0.04", "spacing = 0.04\nperiodic = [0.24, 0.2, 0.0]")
    )
    # The program records; the pages are made here, without measuring the exercises again.
    done = firn("teach", scene, *words, "-o", tmp_path, folder=tmp_path, FIRN_PYTHON="true")
    assert done.returncode == 0, done.stderr
    monkeypatch.setattr(pages, "exercise_values", lambda *_: {"bugs": [], "parameters": []})
    read = lesson_file.read(tmp_path / "lesson.json")
    pages.write(read, tmp_path)
    assert len(list(tmp_path.glob("*.html"))) == 16
    for stage in range(1, 11):
        for field, _, _, difference in by_hand.run(read, stage):
            assert difference < 100 * 2.0**-52, (stage, field)
    if "--particle" in words:
        assert "particle 7" in (tmp_path / "index.html").read_text()


def test_verify_finds_an_exercise_too(tmp_path):
    done = firn("verify", "--solver", "exercise:9", "--fail-fast", folder=tmp_path)
    assert done.returncode == 1
    assert "exercise:9" in done.stdout


def test_mathml():
    assert mathml.formula(r"\v_i") == (
        '<math xmlns="http://www.w3.org/1998/Math/MathML" display="inline"><mrow><msub>'
        '<mi mathvariant="normal" class="b">v</mi><mi>i</mi></msub></mrow></math>'
    )
