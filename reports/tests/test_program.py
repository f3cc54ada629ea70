# SPDX-License-Identifier: BSD-3-Clause
"""`firn report` hands every option over to this package."""

import os
import subprocess

import pytest

import synthetic

PLASTIC = "optimized,float,1T,plastic,100000"


def firn(*words, folder):
    return subprocess.run(
        [os.environ["FIRN_PROGRAM"], "report", *map(str, words)],
        cwd=folder,
        capture_output=True,
        check=False,
        text=True,
        timeout=300,
    )


def test_readme_table_is_printed_and_no_page_written(tmp_path):
    answer = firn(synthetic.write_results(tmp_path / "new.h5"), "--readme-table", folder=tmp_path)
    assert answer.returncode == 0, answer.stderr
    assert answer.stdout.startswith("| particle-steps per second |")
    assert not (tmp_path / "report").exists()


@pytest.mark.parametrize(("threshold", "status"), [("0.1", 1), ("9", 0)])
def test_threshold_decides_the_exit_status(tmp_path, threshold, status):
    old = synthetic.write_results(tmp_path / "old.h5")
    new = synthetic.write_results(tmp_path / "new.h5", slow={PLASTIC: 1.5})
    answer = firn(new, "--baseline", old, "--threshold", threshold, folder=tmp_path)
    assert answer.returncode == status, answer.stderr


def refused(answer, says):
    """Exit 2 and one line."""
    assert answer.returncode == 2, answer.stderr
    assert answer.stderr.count("\n") == 1, answer.stderr
    assert says in answer.stderr


def test_a_page_replaces_only_pages(tmp_path):
    results = synthetic.write_results(tmp_path / "new.h5")
    for _ in range(2):
        assert firn(results, "-o", "page", folder=tmp_path).returncode == 0
    for name in ("index.html", "csv/cases.csv"):
        folder = tmp_path / name.replace("/", "-")
        (folder / name).parent.mkdir(parents=True)
        (folder / name).write_text("mine")
        refused(firn(results, "-o", folder, folder=tmp_path), "--force")
        assert [path.name for path in folder.rglob("*") if path.is_file()] == [name.split("/")[-1]]
        assert (folder / name).read_text() == "mine"
        assert firn(results, "-o", folder, "--force", folder=tmp_path).returncode == 0
        assert (folder / name).read_text() != "mine"


def test_a_page_never_replaces_an_input(tmp_path):
    results = synthetic.write_results(tmp_path / "new.h5")
    old = synthetic.write_results(tmp_path / "old.h5")
    (tmp_path / "page").mkdir()
    (tmp_path / "page" / "index.html").symlink_to(old)
    before = old.read_bytes()
    refused(firn(results, "--baseline", old, "-o", "page", "--force", folder=tmp_path), "an input")
    assert old.read_bytes() == before
