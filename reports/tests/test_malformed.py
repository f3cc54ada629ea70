# SPDX-License-Identifier: BSD-3-Clause
"""Malformed files get one line and exit 2, or make a case a failed one; never a traceback."""

import shutil

import h5py
import numpy as np
import pytest

from firn_reports.__main__ import main

import synthetic

CASE = "cases/steps/optimized,float,1T,plastic,100000"
TIME = f"{CASE}/quantities/time"


@pytest.fixture(scope="module")
def results_file(tmp_path_factory):
    return synthetic.write_results(tmp_path_factory.mktemp("results") / "good.h5")


def replaced(source, path, name, value):
    """A copy of a file with another dataset in the place of one; None removes it."""
    shutil.copy(source, path)
    with h5py.File(path, "r+") as file:
        attributes = dict(file[name].attrs)
        del file[name]
        if value is not None:
            file[name] = value
            file[name].attrs.update(attributes)
    return path


def run(capsys, *words):
    """Exit status and the lines on stderr."""
    status = main([str(word) for word in words])
    return status, capsys.readouterr().err.splitlines()


def refused(capsys, *words, says):
    status, lines = run(capsys, *words)
    assert status == 2, lines
    assert len(lines) == 1, lines
    assert says in lines[0]


@pytest.mark.parametrize("value", [np.nan, np.inf, -1.0, 0.0])
def test_times_that_cannot_be_are_worse_than_any(tmp_path, capsys, results_file, value):
    with h5py.File(results_file) as file:
        times = file[TIME][()]
    times[2] = value
    bad = replaced(results_file, tmp_path / "bad.h5", TIME, times)
    status, lines = run(capsys, bad, "--baseline", results_file, "-o", tmp_path / "page")
    assert status == 1
    assert CASE.split("/", 1)[1] in lines[-1]
    assert f"repetition 2 is {value:g}" in lines[-1]
    refused(
        capsys, results_file, "--baseline", bad, "-o", tmp_path / "page", says="repetition 2 is"
    )


def test_no_times_are_worse_than_any(tmp_path, capsys, results_file):
    bad = replaced(results_file, tmp_path / "bad.h5", TIME, np.zeros(0))
    status, lines = run(capsys, bad, "--baseline", results_file, "-o", tmp_path / "page")
    assert status == 1
    assert "no repetitions" in lines[-1]


def test_a_baseline_without_common_cases_is_none(tmp_path, capsys, results_file):
    shutil.copy(results_file, tmp_path / "other.h5")
    with h5py.File(tmp_path / "other.h5", "r+") as file:
        del file["cases"]
    refused(capsys, results_file, "--baseline", tmp_path / "other.h5", says="in common")


@pytest.mark.parametrize("threshold", ["nan", "inf", "0", "-1", "wide"])
def test_a_threshold_is_a_number_above_zero(capsys, results_file, threshold):
    refused(
        capsys,
        results_file,
        "--baseline",
        results_file,
        f"--threshold={threshold}",
        says="--threshold",
    )


MALFORMED = {
    "scalar": 1.0,
    "table": np.ones((3, 3)),
    "text": np.bytes_("nine"),
    "texts": np.array([b"a", b"b"]),
    "missing": None,
}


@pytest.mark.parametrize("value", MALFORMED.values(), ids=MALFORMED)
@pytest.mark.parametrize("name", [TIME, f"{CASE}/calibration", "verify/optimized, float/error"])
def test_malformed_results_get_one_line(tmp_path, capsys, results_file, name, value):
    if name == TIME and value is None:
        pytest.skip("a case may lack a quantity")
    bad = replaced(results_file, tmp_path / "bad.h5", name, value)
    refused(capsys, bad, "-o", tmp_path / "page", says="bad.h5")


@pytest.mark.parametrize("value", [*MALFORMED.values(), np.nan], ids=[*MALFORMED, "nan"])
@pytest.mark.parametrize(
    "name",
    [
        "VTKHDF/Steps/Values",
        "VTKHDF/Points",
        "VTKHDF/PointData/F_P",
        "VTKHDF/PointData/mass",
        "VTKHDF/NumberOfPoints",
        "firn/diagnostics/time",
        "firn/diagnostics/momentum",
        "firn/diagnostics/kinetic_energy",
    ],
)
def test_malformed_trajectories_get_one_line(tmp_path, capsys, trajectory_file, name, value):
    with h5py.File(trajectory_file) as file:
        old = file[name][()]
    if isinstance(value, float) and np.isnan(value):
        if old.dtype.kind != "f":
            pytest.skip("an integer is never NaN")
        value = old.copy()
        value.flat[1] = np.nan
    bad = replaced(trajectory_file, tmp_path / "bad.vtkhdf", name, value)
    refused(capsys, bad, "-o", tmp_path / "page", says="bad.vtkhdf")
    assert not (tmp_path / "page").exists()
