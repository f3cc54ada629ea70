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
