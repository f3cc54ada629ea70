# SPDX-License-Identifier: BSD-3-Clause
"""The pages in a real browser: nothing broken or wider than the screen, no dead anchor."""

import shutil

import pytest

from firn_reports.__main__ import main

import synthetic

webdriver = pytest.importorskip("selenium.webdriver")
DRIVER = shutil.which("chromedriver")
pytestmark = pytest.mark.skipif(not DRIVER, reason="no chromedriver on this machine")


@pytest.fixture(scope="module")
def browser():
    options = webdriver.ChromeOptions()
    for argument in (
        "--headless",
        "--no-sandbox",
        "--disable-gpu",
        "--disable-background-networking",
        "--hide-scrollbars",
    ):
        options.add_argument(argument)
    driver = webdriver.Chrome(options=options, service=webdriver.ChromeService(DRIVER))
    yield driver
    driver.quit()


@pytest.fixture(scope="module", params=["results", "baseline", "trajectory"])
def page(request, tmp_path_factory, trajectory_file):
    folder = tmp_path_factory.mktemp(request.param)
    if request.param == "trajectory":
        arguments = [str(trajectory_file)]
    else:
        arguments = [
            str(
                synthetic.write_results(
                    folder / "r.h5", slow={"optimized,float,1T,plastic,100000": 2}
                )
            )
        ]
    if request.param == "baseline":
        arguments += ["--baseline", str(synthetic.write_results(folder / "old.h5"))]
    main([*arguments, "-o", str(folder / "out")])
    return (folder / "out" / "index.html").as_uri()


def show(browser, url, width, dark=False):
    browser.execute_cdp_cmd(
        "Emulation.setDeviceMetricsOverride",
        {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": False},
    )
    browser.execute_cdp_cmd(
        "Emulation.setEmulatedMedia",
        {"features": [{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}]},
    )
    browser.get(url)
    assert browser.execute_script("return window.innerWidth") == width


@pytest.mark.parametrize("width", [400, 1400])
def test_nothing_is_wider_than_the_screen(browser, page, width):
    show(browser, page, width)
    browser.execute_script("document.querySelectorAll('details').forEach(d => d.open = true)")
    assert browser.execute_script("return document.documentElement.scrollWidth") <= width
    # Text that sticks out of its card, outside of what may scroll.
    out = browser.execute_script("""return [...document.querySelectorAll('.tile, figure, .verdict, h1, h2, nav')]
        .filter(e => e.getBoundingClientRect().right > window.innerWidth + 0.5 || e.scrollWidth > e.clientWidth + 1).map(e => e.outerHTML.slice(0, 120))""")
    assert out == []


def test_pictures_are_there_and_anchors_lead_somewhere(browser, page):
    show(browser, page, 1400)
    images = browser.execute_script(
        "return [...document.images].map(i => i.complete && i.naturalWidth > 0)"
    )
    assert all(images)
    plots = browser.execute_script(
        "return [...document.querySelectorAll('.plot svg')].map(s => [s.getBoundingClientRect().width, s.getBoundingClientRect().height])"
    )
    assert len(plots) >= 8
    assert all(w > 200 and h > 60 for w, h in plots)
    dead = browser.execute_script("""return [...document.querySelectorAll('a[href^="#"]')].map(a => a.getAttribute('href').slice(1))
        .filter(id => !document.getElementById(id))""")
    assert dead == []
    twice = browser.execute_script(
        "const ids = [...document.querySelectorAll('[id]')].map(e => e.id); return ids.filter((id, i) => ids.indexOf(id) !== i)"
    )
    assert twice == []
    lost = browser.execute_script("""return [...document.querySelectorAll('svg use')].map(u => u.getAttribute('href') || u.getAttribute('xlink:href'))
        .filter(h => h && !document.getElementById(h.slice(1)))""")
    assert lost == []


def test_the_summary_fits_a_screen(browser, page):
    show(browser, page, 1400)
    bottom = browser.execute_script(
        "return document.getElementById('summary').getBoundingClientRect().bottom"
    )
    assert bottom <= 900


def test_nothing_comes_from_the_network(browser, page):
    show(browser, page, 1400)
    outside = browser.execute_script(
        "return performance.getEntriesByType('resource').map(e => e.name).filter(n => !n.startsWith('data:') && !n.startsWith('file:'))"
    )
    assert outside == []


def luminance(colour):
    values = [int(v) for v in colour[colour.index("(") + 1 :].rstrip(")").split(",")[:3]]
    return sum(
        weight * (v / 255) ** 2.2
        for weight, v in zip((0.2126, 0.7152, 0.0722), values, strict=True)
    )


@pytest.mark.parametrize("dark", [False, True])
def test_text_stands_out_in_both_themes(browser, page, dark):
    show(browser, page, 1400, dark)
    paper = browser.execute_script("return getComputedStyle(document.body).backgroundColor")
    assert (luminance(paper) < 0.1) == dark
    for selector, least in (
        (".plot svg text", 4.5),
        ("h1", 7),
        ("figcaption", 4.5),
        (".tile .note", 4.5),
    ):
        colour = browser.execute_script(
            """const e = document.querySelector(arguments[0]); if (!e) return null;
            const s = getComputedStyle(e); return e instanceof SVGElement ? s.fill : s.color""",
            selector,
        )
        if colour is None:
            continue
        high, low = sorted([luminance(colour), luminance(paper)], reverse=True)
        assert (high + 0.05) / (low + 0.05) >= least, (selector, colour, paper)


def test_a_keyboard_opens_a_table(browser, page):
    show(browser, page, 1400)
    before = browser.execute_script(
        "const d = document.querySelector('details:not([open])'); d.id = d.id || 'probe'; d.querySelector('summary').focus(); return d.id"
    )
    browser.switch_to.active_element.send_keys("\n")
    assert browser.execute_script("return document.getElementById(arguments[0]).open", before)
