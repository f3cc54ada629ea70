# SPDX-License-Identifier: BSD-3-Clause
import json

import pytest

import synthetic


@pytest.fixture(scope="session")
def trajectory_file(tmp_path_factory):
    return synthetic.write_trajectory(
        tmp_path_factory.mktemp("trajectory") / "ball.vtkhdf", particles=800, spare=4
    )


@pytest.fixture
def check_file(tmp_path):
    def write(verdict, scene_text=synthetic.SCENE, **changes):
        path = tmp_path / f"{verdict}.json"
        check = synthetic.check(verdict, scene_text, changes.pop("missing", ()))
        path.write_text(json.dumps(check | changes))
        return path

    return write
