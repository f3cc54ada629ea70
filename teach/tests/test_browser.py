# SPDX-License-Identifier: BSD-3-Clause
"""The pages in a real browser."""

import shutil
import subprocess
import time

import pytest

from firn_teach import chapter, pages

from conftest import BUILD, ROOT, WEB_MODULE, firn

NAMES = ["index.html", *chapter.STAGE_FILES, *(f"{name}.html" for name in chapter.EXTRAS)]
needs_module = pytest.mark.skipif(not WEB_MODULE.exists(), reason="built without Emscripten")


def show(browser, lesson, name, width=1400, dark=False):
    browser.execute_cdp_cmd(
        "Emulation.setDeviceMetricsOverride",
        {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": False},
    )
    browser.execute_cdp_cmd(
        "Emulation.setEmulatedMedia",
        {"features": [{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}]},
    )
    browser.get((lesson.folder / name).as_uri())
    if name == "interactive.html" and WEB_MODULE.exists():
        wait(browser, "return !document.getElementById('app').hidden")


def wait(browser, script, seconds=20):
    end = time.monotonic() + seconds
    while not browser.execute_script(script):
        assert time.monotonic() < end, script
        time.sleep(0.05)


@pytest.mark.parametrize("name", NAMES)
def test_page(browser, lesson, name):
    """Nothing wider than the screen, no dead anchor or link, pictures, nothing from the network."""
    for width in (400, 1400):
        show(browser, lesson, name, width)
        browser.execute_script("document.querySelectorAll('details').forEach(d => d.open = true)")
        assert browser.execute_script("return window.innerWidth") == width
        assert browser.execute_script("return document.documentElement.scrollWidth") <= width
        out = browser.execute_script("""return [...document.querySelectorAll('figure, h1, h2, h3, p, .exercise, .site, canvas, table.values, .sliders label')]
            .filter(e => e.getBoundingClientRect().right > window.innerWidth + 0.5 || e.scrollWidth > e.clientWidth + 1 && getComputedStyle(e).overflowX === 'visible' && !e.matches('canvas, .equation *'))
            .map(e => e.outerHTML.slice(0, 160))""")
        assert out == [], (name, width)
    plots = browser.execute_script(
        "return [...document.querySelectorAll('.plot svg')].map(s => [s.getBoundingClientRect().width, s.getBoundingClientRect().height])"
    )
    assert all(w > 200 and h > 100 for w, h in plots)
    if name in chapter.STAGE_FILES:
        assert len(plots) >= 1
        drawn = browser.execute_script(
            "return [...document.querySelectorAll('.plot svg')].map(s => s.querySelectorAll('path, use').length)"
        )
        assert min(drawn) > 20
        assert (
            browser.execute_script("return document.querySelectorAll('.equation math').length") >= 1
        )
    dead = browser.execute_script(
        "return [...document.querySelectorAll('a[href^=\"#\"]')].map(a => a.getAttribute('href').slice(1)).filter(id => !document.getElementById(id))"
    )
    assert dead == []
    links = browser.execute_script(
        "return [...document.querySelectorAll('a[href]:not([href^=\"#\"])')].map(a => a.getAttribute('href'))"
    )
    for link in set(links):
        file, _, anchor = link.partition("#")
        assert (lesson.folder / file).is_file(), link
        assert not anchor or f'id="{anchor}"' in lesson.page(file), link
    twice = browser.execute_script(
        "const ids = [...document.querySelectorAll('[id]')].map(e => e.id); return ids.filter((id, i) => ids.indexOf(id) !== i)"
    )
    assert twice == []
    outside = browser.execute_script(
        "return performance.getEntriesByType('resource').map(e => e.name).filter(n => !n.startsWith('data:') && !n.startsWith('file:'))"
    )
    assert outside == []
    errors = [entry for entry in browser.get_log("browser") if entry["level"] == "SEVERE"]
    assert errors == []


def luminance(colour):
    values = [int(float(v)) for v in colour[colour.index("(") + 1 :].rstrip(")").split(",")[:3]]
    return sum(
        weight * (v / 255) ** 2.2
        for weight, v in zip((0.2126, 0.7152, 0.0722), values, strict=True)
    )


@pytest.mark.parametrize("dark", [False, True])
def test_text_stands_out_in_both_themes(browser, lesson, dark):
    show(browser, lesson, "03_grid_forces.html", 1400, dark)
    paper = luminance(
        browser.execute_script("return getComputedStyle(document.body).backgroundColor")
    )
    assert (paper < 0.1) == dark
    for selector in (
        "h1",
        ".lead",
        ".text p",
        "figcaption",
        "td.value",
        "pre.source",
        "pre.source .c",
        "pre.source .k",
        "pre.source .n",
        "math",
        ".plot svg text",
    ):
        colour = luminance(
            browser.execute_script(
                "const e = document.querySelector(arguments[0]), s = getComputedStyle(e); return e instanceof SVGElement ? s.fill : s.color",
                selector,
            )
        )
        assert (max(paper, colour) + 0.05) / (min(paper, colour) + 0.05) >= 4.5, selector


def press(browser, keys):
    browser.switch_to.active_element.send_keys(keys)


def test_keyboard_turns_pages_and_opens_answers(browser, lesson):
    show(browser, lesson, "01_rasterize.html")
    press(browser, "\t")
    assert browser.execute_script("return document.activeElement.className") == "skip"
    browser.execute_script("document.querySelector('a[rel=next]').focus()")
    press(browser, "\n")
    wait(browser, "return location.pathname.endsWith('02_volumes.html')")
    show(browser, lesson, "exercises.html")
    browser.execute_script("document.querySelector('details summary').focus()")
    press(browser, "\n")
    assert browser.execute_script("return document.querySelector('details').open")


# --- the interactive page -------------------------------------------------------------------


def invariant(browser, name):
    return float(
        browser.execute_script(
            'return document.querySelector(`[data-invariant="${arguments[0]}"]`).textContent', name
        )
    )


def state_hash(browser):
    return browser.execute_script("return document.getElementById('hash').textContent")


def native_hash(*words):
    return subprocess.run(
        [BUILD / "bin/firn_web_hash", *map(str, words)],
        capture_output=True,
        text=True,
        check=True,
        timeout=120,
    ).stdout.strip()


@needs_module
@pytest.mark.parametrize("words", [(0, 100), (1, 60), (0, 60, "3=5", "6=0.5", "8=0.001", "7=1")])
def test_webassembly_computes_the_bits_of_the_native_solver(words):
    node = shutil.which("node") or shutil.which("nodejs")
    done = subprocess.run(
        [node, ROOT / "web/hash.js", WEB_MODULE, *map(str, words)],
        check=False,
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == native_hash(*words)


@needs_module
def test_the_page_computes_the_bits_of_the_native_solver(browser, lesson):
    show(browser, lesson, "interactive.html")
    for _ in range(20):
        browser.execute_script("document.getElementById('step').click()")
    assert state_hash(browser) == native_hash(0, 20) != native_hash(0, 19)


def test_the_page_s_scene_is_the_built_in_one(tmp_path):
    """web/session.cpp builds tiny_impact by hand: ten steps leave the program's particles."""
    done = firn(
        "run",
        "tiny_impact",
        "--solver",
        "reference",
        "--steps",
        10,
        "-o",
        tmp_path / "t.vtkhdf",
        folder=tmp_path,
    )
    assert done.returncode == 0, done.stderr
    import h5py
    import numpy as np

    with h5py.File(tmp_path / "t.vtkhdf") as f:
        vtk = f["VTKHDF"]
        frame = int(vtk["Steps"].attrs["NSteps"]) - 1
        rows = slice(int(vtk["Steps/PointOffsets"][frame]), None)
        count = int(vtk["NumberOfPoints"][0])
        data = vtk["PointData"]
        rows = slice(rows.start, rows.start + count)
        time_ = np.array([vtk["Steps/Values"][frame]])
        # Column-major, as Eigen holds its matrices.
        matrices = [
            np.swapaxes(data[name][rows].reshape(-1, 3, 3), 1, 2) for name in ("F_E", "F_P")
        ]
        arrays = [
            time_,
            vtk["Points"][rows],
            data["velocity"][rows],
            data["volume"][rows],
            *matrices,
        ]
    value = 0xCBF29CE484222325
    for byte in b"".join(np.ascontiguousarray(a, dtype="<f8").tobytes() for a in arrays):
        value = ((value ^ byte) * 0x100000001B3) % 2**64
    assert f"{value:016x}" == native_hash(0, 10)


@needs_module
@pytest.mark.parametrize("preset", ["0", "1"])
def test_stepping_changes_the_state_and_conserves_mass_and_momentum(browser, lesson, preset):
    show(browser, lesson, "interactive.html")
    browser.execute_script(
        "const s = document.getElementById('preset'); s.value = arguments[0]; s.dispatchEvent(new Event('change'))",
        preset,
    )
    mass, start = invariant(browser, "mass"), state_hash(browser)
    momentum = [invariant(browser, f"momentum-{c}") for c in "xyz"]
    seen = set()
    for stage in range(1, 11):
        browser.execute_script("document.getElementById('next').click()")
        seen.add(
            browser.execute_script(
                "return document.querySelector('#stages li[aria-current]').dataset.stage"
            )
        )
        assert invariant(browser, "mass") == mass
        # Each sum over n particles or nodes is off by at most n units of roundoff of what it sums.
        assert invariant(browser, "left-over") < stage * 600 * 2**-52
        assert abs(invariant(browser, "grid-mass") - mass) < 600 * 2**-52 * mass
    assert seen == {str(n) for n in range(1, 11)}
    assert state_hash(browser) != start
    for _ in range(100):
        browser.execute_script("document.getElementById('step').click()")
    assert invariant(browser, "mass") == mass
    assert invariant(browser, "left-over") < 1010 * 600 * 2**-52  # of 101 steps
    assert invariant(browser, "elastic") > 0
    after = [invariant(browser, f"momentum-{c}") for c in "xyz"]
    if preset == "1":  # nothing outside acts: momentum is what it was, to twelve digits shown
        assert all(abs(a - b) < 1e-10 * mass for a, b in zip(after, momentum, strict=True))
    else:  # the ground has stopped most of it
        assert after[2] > 0.5 * momentum[2]


@needs_module
def test_keyboard_steps_and_chooses(browser, lesson):
    show(browser, lesson, "interactive.html")
    start = state_hash(browser)
    body = browser.find_element("css selector", "body")
    body.send_keys("n")
    assert "Done: 1 Rasterize" in browser.execute_script(
        "return document.getElementById('status').textContent"
    )
    body.send_keys("s")
    assert "Step 1," in browser.execute_script(
        "return document.getElementById('status').textContent"
    )
    assert state_hash(browser) != start
    for canvas, key, table in (
        ("particles", "\ue013", "particle-numbers"),
        ("grid", "\ue014", "node-numbers"),
        ("grid", "\ue00e", "node-numbers"),
    ):
        before = browser.execute_script(
            "return document.getElementById(arguments[0]).textContent", table
        )
        browser.execute_script("document.getElementById(arguments[0]).focus()", canvas)
        press(browser, key)
        assert (
            browser.execute_script(
                "return document.getElementById(arguments[0]).textContent", table
            )
            != before
        ), canvas
    browser.execute_script("document.getElementById('run').focus()")
    press(browser, " ")
    wait(
        browser,
        "return Number(document.getElementById('status').textContent.match(/Step (\\d+)/)[1]) > 4",
    )
    press(browser, " ")
    assert (
        browser.execute_script("return document.getElementById('run').getAttribute('aria-pressed')")
        == "false"
    )
    body.send_keys("r")
    assert state_hash(browser) == start


@needs_module
def test_every_slider_has_a_name_and_acts(browser, lesson):
    show(browser, lesson, "interactive.html")
    labels = browser.execute_script(
        "return [...document.querySelectorAll('#sliders label')].map(l => l.textContent)"
    )
    assert len(labels) == 13
    # Thrown fast, the ball meets the ground and yields within 25 steps.
    plain = native_hash(0, 26, "12=15")
    restart = """document.getElementById('defaults').click();
        const speed = document.getElementById('parameter-12'); speed.value = 15; speed.dispatchEvent(new Event('input'));
        document.getElementById('restart').click();
        for (let n = 0; n < 25; ++n) document.getElementById('step').click();"""
    for k in (0, 1, 3, 4, 5, 6, 7, 8, 9, 10):  # those that act without a restart
        browser.execute_script(
            restart
            + """
            const slider = document.getElementById(`parameter-${arguments[0]}`);
            slider.value = slider.min;
            slider.dispatchEvent(new Event('input'));
            document.getElementById('step').click()""",
            k,
        )
        changed = state_hash(browser)
        assert (changed == plain) == (k == 7), labels[
            k
        ]  # β is 0 in this scene: its slider is there already
    browser.execute_script("""document.getElementById('defaults').click();
        for (const k of [2, 11, 12]) { const s = document.getElementById(`parameter-${k}`); s.value = s.max; s.dispatchEvent(new Event('input')); }
        document.getElementById('restart').click()""")
    assert invariant(browser, "mass") > 2 * 1.7  # twice the density and coarser cells
    browser.execute_script(
        restart
        + """
        const b = document.getElementById('parameter-7'); b.value = 1; b.dispatchEvent(new Event('input')); document.getElementById('step').click()"""
    )
    assert state_hash(browser) != plain
    values = browser.execute_script(
        "return [...document.querySelectorAll('#sliders input')].map(i => i.getAttribute('aria-valuetext'))"
    )
    assert all(values)


@needs_module
def test_a_step_that_fails_says_so(browser, lesson):
    show(browser, lesson, "interactive.html")
    browser.execute_script("""const dt = document.getElementById('parameter-8'); dt.value = dt.max; dt.dispatchEvent(new Event('input'));
        for (let n = 0; n < 60 && document.getElementById('failure').hidden; ++n) document.getElementById('step').click()""")
    message = browser.execute_script(
        "const f = document.getElementById('failure'); return f.hidden ? '' : f.textContent"
    )
    assert "stage" in message
    assert "last good state" in message
    assert invariant(browser, "mass") > 0


def test_without_the_module_the_page_says_how_to_get_it(browser, lesson, tmp_path):
    from firn_teach import interactive

    page = pages.environment().get_template("interactive.html.jinja")
    text = page.render(
        page=chapter.chapter("interactive.html", "interactive.html"),
        stages=[],
        site=[],
        footer="",
        **interactive.values(""),
    )
    (tmp_path / "interactive.html").write_text(text, encoding="utf-8")
    browser.get((tmp_path / "interactive.html").as_uri())
    assert "./run teach" in browser.execute_script(
        "return document.getElementById('missing').textContent"
    )
