"""Roads of the table of grades and banks."""

from pathlib import Path

import numpy as np
import pytest

from foreride.scenarios.definition.loading import load
from foreride.scenarios.tables.grades import banked_profile, road_fields


def test_a_banked_road_is_a_plane_behind_its_curve_as_far_as_a_camera_looks(tmp_path: Path) -> None:
    file = tmp_path / "bank.csv"
    file.write_text(banked_profile(60.0, 20.0, 0.03))
    banked = load("rough_b_80", road_fields(60.0, 20.0, 0.0, str(file))).road
    level = load("rough_b_80", road_fields(60.0, 20.0, 0.0, None)).road
    y = np.array([-4.0, -0.75, 0.0, 0.75, 4.0])
    for x in (31.0, 45.2):
        raised = banked.height(np.full(5, x), y) - level.height(np.full(5, x), y)
        assert raised == pytest.approx(0.03 * y, abs=1e-5)


def test_a_road_climbs_with_the_grade_behind_its_curve() -> None:
    climbing, level = (load("rough_b_80", road_fields(60.0, 20.0, grade, None)).road for grade in (0.06, 0.0))
    x, y = np.array([40.0, 50.0]), np.zeros(2)
    raised = climbing.height(x, y) - level.height(x, y)
    assert raised[1] - raised[0] == pytest.approx(0.6, abs=1e-6)
