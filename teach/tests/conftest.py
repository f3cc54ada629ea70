# SPDX-License-Identifier: BSD-3-Clause
"""The lesson under test: made once, by the program, as a user would."""

import json
import os
import resource
import shutil
import subprocess
from pathlib import Path
from types import SimpleNamespace

import pytest

ROOT = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ.get("FIRN_BUILD", ROOT / "build/release"))
PROGRAM = BUILD / "bin/firn"
WEB_MODULE = BUILD / "web/firn_web.js"


def firn(*words, folder, **environment):
    return subprocess.run(
        [PROGRAM, *map(str, words)],
        cwd=folder,
        capture_output=True,
        check=False,
        text=True,
        timeout=300,
        env=os.environ | environment,
    )


@pytest.fixture(scope="session")
def lesson(tmp_path_factory):
    folder = tmp_path_factory.mktemp("lesson")
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = firn("teach", "-o", folder, folder=folder)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    # Of the processor: the time of day depends on what else the machine does.
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    assert done.returncode == 0, done.stderr
    data = json.loads((folder / "lesson.json").read_text())
    return SimpleNamespace(
        folder=folder,
        seconds=seconds,
        data=data,
        page=lambda name: (folder / name).read_text(encoding="utf-8"),
    )


@pytest.fixture(scope="session")
def browser():
    webdriver = pytest.importorskip("selenium.webdriver")
    driver = shutil.which("chromedriver")
    if not driver:
        pytest.skip("no chromedriver on this machine")
    options = webdriver.ChromeOptions()
    for argument in (
        "--headless",
        "--no-sandbox",
        "--disable-gpu",
        "--disable-background-networking",
        "--hide-scrollbars",
    ):
        options.add_argument(argument)
    chrome = webdriver.Chrome(options=options, service=webdriver.ChromeService(driver))
    yield chrome
    chrome.quit()
