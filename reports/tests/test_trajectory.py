# SPDX-License-Identifier: BSD-3-Clause
"""Reading, the laws of free flight, and the page of a trajectory."""

import h5py
import numpy as np
import pytest

from firn_reports import InputError, trajectory, trajectory_page
from firn_reports.__main__ import main
from firn_reports.colliders import collider_distance, free_flight_reach
from firn_reports.laws import Laws
from firn_reports.scene_hash import scene_hash

import synthetic


def test_only_the_valid_rows_and_frames_of_an_interrupted_file_are_read(trajectory_file):
    t = trajectory.read(trajectory_file)
    assert len(t.times) == 13
    assert len(t.diagnostics["time"]) == 600
    assert t.steps == 600
    assert t.times[-1] == pytest.approx(0.6)
    assert t.diagnostics["mass"].min() > 0
    assert t.frame(-1).time == t.times[-1]
    assert np.isfinite(t.frame(-1).x).all()
    assert t.units["momentum"] == "kg m/s"


def test_free_flight_holds_to_roundoff_until_contact_and_not_after(trajectory_file):
    t = trajectory.read(trajectory_file)
    laws = Laws(t, t.frame(0))
    # The ball hangs 0.7 m above the ground; a particle's nodes reach 2√3 h further down.
    fallen = 1.0 - t.diagnostics["center_of_mass"][laws.free][-1][2]
    assert fallen == pytest.approx(0.7 - 2 * np.sqrt(3) * 0.05, abs=0.03)
    # 600 sums, each exact to a few eps.
    assert laws.momentum_error[laws.free].max() < 600 * 2.0**-52
    assert laws.center_error[laws.free].max() < 600 * 2.0**-52
    assert laws.momentum_error[-1] > 0.1


def test_a_broken_law_is_seen(tmp_path):
    path = synthetic.write_trajectory(tmp_path / "bad.vtkhdf", particles=200)
    with h5py.File(path, "a") as file:
        momentum = file["firn/diagnostics/momentum"]
        momentum[100] = momentum[100] + [1e-6, 0, 0]
    t = trajectory.read(path)
    tiles = trajectory_page.tiles(t, Laws(t, t.frame(0)), [])
    assert {tile.label: tile.kind for tile in tiles}["Momentum in free flight"] == "bad"


@pytest.mark.parametrize(
    ("shape", "x", "phi"),
    [
        ({"type": "half-space", "point": [0, 0, 1], "normal": [0, 0, 2]}, [3, 4, 3], 2.0),
        ({"type": "sphere", "center": [1, 0, 0], "radius": 1}, [4, 0, 0], 2.0),
        ({"type": "box", "min": [0, 0, 0], "max": [2, 2, 2]}, [1, 1, 1.5], -0.5),
        ({"type": "box", "min": [0, 0, 0], "max": [2, 2, 2]}, [5, 6, 1], 5.0),
        (
            {"type": "cylinder", "center": [0, 0, 0], "axis": [0, 0, 3], "radius": 1, "height": 2},
            [3, 0, 0],
            2.0,
        ),
    ],
)
def test_signed_distances(shape, x, phi):
    assert collider_distance({"shape": shape}, np.array([x], float), 0.0)[0] == pytest.approx(phi)
    assert collider_distance({"shape": shape, "inside": True}, np.array([x], float), 0.0)[
        0
    ] == pytest.approx(-phi)


def test_a_collider_carries_its_shape_along():
    box = {
        "shape": {"type": "box", "min": [-2, -1, -1], "max": [2, 1, 1]},
        "velocity": [1, 0, 0],
        "angular_velocity": [0, 0, np.pi / 2],
    }
    # After 1 s: moved by 1 along x, turned by 90° about z, so its long side lies along y.
    assert collider_distance(box, np.array([[1.0, 3.0, 0.0]]), 1.0)[0] == pytest.approx(1.0)


def test_reach_is_unknown_beside_a_moving_collider():
    moving = {"shape": {"type": "sphere", "center": [0, 0, 0], "radius": 1}, "velocity": [1, 0, 0]}
    assert (
        free_flight_reach({"grid": {"spacing": 0.1}, "collider": [moving]}, np.zeros((1, 3)))
        is None
    )
    assert free_flight_reach({"grid": {"spacing": 0.1}}, np.zeros((1, 3))) == np.inf


@pytest.mark.parametrize(("verdict", "kind"), [("VALID", "good"), ("INVALID", "bad")])
def test_the_page_is_one_file_with_its_verdict(
    trajectory_file, check_file, tmp_path, verdict, kind
):
    assert (
        main(
            [str(trajectory_file), "--check", str(check_file(verdict)), "-o", str(tmp_path / "out")]
        )
        == 0
    )
    html = (tmp_path / "out" / "index.html").read_text()
    assert f'class="verdict {kind}"' in html
    assert f"<strong>{verdict}</strong>" in html
    assert "http://" not in html.replace("http://www.w3.org", "")
    assert "https://" not in html
    assert (tmp_path / "out" / "snowball.png").read_bytes().startswith(b"\x89PNG")
    rows = (tmp_path / "out" / "csv" / "diagnostics.csv").read_text().splitlines()
    assert rows[0].startswith("time [s],dt [s]")
    assert len(rows) == 401


def test_valid_does_not_stand_alone_where_something_is_missing(
    trajectory_file, check_file, tmp_path
):
    check = check_file("VALID", missing=["contact"])
    assert main([str(trajectory_file), "--check", str(check), "-o", str(tmp_path / "out")]) == 0
    html = (tmp_path / "out" / "index.html").read_text()
    assert 'class="verdict warn"' in html
    assert "<strong>VALID; not exercised: contact</strong>" in html


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"scene_text": "name = 'another'"}, "scene"),
        ({"subject": "mine"}, "solver"),
        ({"precision": "float"}, "precision"),
        ({"fields": []}, "no verdict"),
        ({"compared": 0}, "no verdict"),
        ({"version": 1}, "version"),
        ({"schema": "else"}, "schema"),
    ],
)
def test_a_check_of_something_else_is_refused(
    trajectory_file, check_file, tmp_path, capsys, changes, message
):
    check = check_file("VALID", **changes)
    assert main([str(trajectory_file), "--check", str(check), "-o", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_the_scene_hash_ignores_what_changes_no_step():
    text = "[grid]\nspacing = 1\n[time]\nend = 1.0\nstep = 0.1\n"
    assert scene_hash(text) == scene_hash(text.replace("end = 1.0", "end = 2.0"))
    assert scene_hash(text) != scene_hash(text.replace("step = 0.1", "step = 0.2"))
    # What firn/scene_hash.cpp gives, too (Scene.TheHashIsThatOfTheReports).
    assert scene_hash(text) == "62848357c0201d2b"


@pytest.mark.parametrize(
    ("damage", "message"),
    [
        (lambda f: f["VTKHDF/Steps"].attrs.__delitem__("NSteps"), "NSteps"),
        (lambda f: f["VTKHDF/Steps"].attrs.__setitem__("NSteps", 0), "at least 1 frame"),
        (lambda f: f["firn/diagnostics"].__delitem__("momentum"), "momentum"),
        (lambda f: f["firn"].attrs.__setitem__("scene", "= 3"), "not TOML"),
        (lambda f: f["firn"].attrs.__setitem__("format", "else"), "allowed: firn-trajectory"),
    ],
)
def test_a_damaged_file_gets_one_line_and_exit_2(tmp_path, capsys, damage, message):
    path = synthetic.write_trajectory(tmp_path / "t.vtkhdf", particles=50, steps=20, frames=3)
    with h5py.File(path, "a") as file:
        damage(file)
    assert main([str(path), "-o", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1
    assert str(path) in error
    assert not (tmp_path / "out").exists()


def test_what_is_no_file_or_no_check_gets_one_line_and_exit_2(tmp_path, trajectory_file, capsys):
    (tmp_path / "text").write_text("{}")
    for arguments in (
        ["nowhere.h5"],
        [str(tmp_path / "text")],
        [str(trajectory_file), "--check", str(tmp_path / "text")],
    ):
        assert main([*arguments, "-o", str(tmp_path / "out")]) == 2
        assert capsys.readouterr().err.count("\n") == 1
    with pytest.raises(InputError):
        trajectory.read(
            synthetic.write_trajectory(
                tmp_path / "t.vtkhdf", particles=9, steps=4, frames=1, scene="name="
            )
        )
