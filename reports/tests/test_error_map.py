# SPDX-License-Identifier: BSD-3-Clause
"""The section about what `firn check --dump` wrote."""

import h5py
import numpy as np
import pytest

from firn_reports import InputError, error_map
from firn_reports.__main__ import main


def write(path, worst):
    """Two frames of three and of four points, the last of each a node."""
    with h5py.File(path, "w") as file:
        file["VTKHDF/NumberOfPoints"] = [3, 4]
        file["VTKHDF/Steps/Values"] = [0.0, 0.5]
        file["VTKHDF/Points"] = np.arange(21.0).reshape(7, 3)
        file["VTKHDF/PointData/id"] = np.array([0, 1, -1, 0, 1, 2, -1], np.float32)
        file["VTKHDF/PointData/node"] = np.zeros((7, 3), np.float32)
        file["VTKHDF/PointData/1_rasterize m_i"] = np.array(worst, np.float32)
        file["VTKHDF/PointData/worst"] = np.array(worst, np.float32)
    return path


def test_the_frame_with_the_largest_error_is_shown(tmp_path):
    errors = error_map.read(write(tmp_path / "e.vtkhdf", [0, 0.5, 0.1, 0, 0, 7, 3]))
    assert errors.time == 0.5
    assert list(errors.worst) == [0, 0, 7, 3]
    assert list(errors.is_node) == [False, False, False, True]
    assert errors.points[0, 0] == 9.0
    assert sorted(errors.rows["1_rasterize m_i"].tolist()) == pytest.approx([0.1, 0.5, 3, 7])
    section = error_map.section(errors, "firn check x --dump e.vtkhdf")
    assert "t = 0.5 s" in section.figures[1].title
    assert "1 particles wrong" in section.figures[1].svg
    assert "1 nodes wrong" in section.figures[1].svg
    assert "1 rasterize: m_i" in section.figures[0].svg


@pytest.mark.parametrize("worst", [[0.0] * 7, [np.inf] * 7])
def test_no_error_and_errors_without_end_make_figures_too(tmp_path, worst):
    errors = error_map.read(write(tmp_path / "e.vtkhdf", worst))
    assert len(error_map.section(errors, "").figures) == 2


def test_the_page_has_the_section(trajectory_file, check_file, tmp_path, capsys):
    dump = write(tmp_path / "e.vtkhdf", [0, 0.5, 0.1, 0, 0, 7, 3])
    arguments = [str(trajectory_file), "--check", str(check_file("INVALID")), "--errors", str(dump)]
    assert main([*arguments, "-o", str(tmp_path / "out")]) == 0
    assert "Where the errors are" in (tmp_path / "out" / "index.html").read_text()
    capsys.readouterr()
    arguments = [str(trajectory_file), "--errors", str(trajectory_file)]
    assert main([*arguments, "-o", str(tmp_path / "other")]) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_another_file_is_refused(tmp_path):
    (tmp_path / "text").write_text("no HDF5")
    with pytest.raises(InputError):
        error_map.read(tmp_path / "text")
