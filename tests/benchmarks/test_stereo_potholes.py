"""Tests of the benchmark of real potholes: what it refuses and, where the photographs are, what it measures.

The photographs lie in `../shared/data/stereo_potholes` beside the repository, or where the environment
variable FORERIDE_STEREO_POTHOLES says.
"""

import os
from pathlib import Path

import numpy as np
import pytest

from benchmarks.stereo_potholes import hole_and_road, main, measured, pairs
from foreride.files.errors import InputError
from foreride.preview.height.road_surface import RoadSurface
from foreride.road.camera.pinhole import Camera, CameraPose

BESIDE = Path(__file__).resolve().parents[2].parent / "shared/data/stereo_potholes"
DATA = Path(os.environ.get("FORERIDE_STEREO_POTHOLES", BESIDE))
CHOSEN = ("model1_07", "model2_11", "model3_05")


def test_the_largest_hole_in_the_middle_is_judged() -> None:
    height = np.zeros((200, 400), np.float32)
    height[90:110, 190:210], height[150:155, 200:205], height[0:60, 0:40] = -0.04, -0.03, -0.05
    pose = CameraPose(0.0, 0.0, 0.5, 0.0, np.deg2rad(45.0), 0.0)
    surface = RoadSurface(height, np.ones(height.shape, bool), pose)
    hole, road = hole_and_road(surface, Camera(400, 200, 300.0))
    assert hole.sum() == 400
    assert not (hole & road).any()
    assert height[road].max() == 0.0
    with pytest.raises(InputError, match="no hole"):
        hole_and_road(surface._replace(height_m=0.0 * height), Camera(400, 200, 300.0))


def test_a_folder_without_pairs_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--data", str(tmp_path)]) == 2
    assert "holds no pairs model*_left.png" in capsys.readouterr().err
    (tmp_path / "model1_01_left.png").write_bytes(b"no image")
    assert main(["--data", str(tmp_path)]) == 2
    assert "model1_01" in capsys.readouterr().err


@pytest.mark.skipif(not DATA.is_dir(), reason="needs the photographs")
def test_road_and_depth_of_real_potholes() -> None:
    results = {name: measured(name, left, right) for name, left, right in pairs(DATA) if name in CHOSEN}
    assert set(results) == set(CHOSEN)
    assert max(one.road_rms_mm for one in results.values()) < 2.0
    assert abs(results["model3_05"].excess_mm) < 4.0
    # Deeper than the casts, for reasons that the benchmark names.
    assert results["model1_07"].depth_mm == pytest.approx(46.9, abs=2.0)
    assert results["model2_11"].depth_mm == pytest.approx(47.0, abs=2.0)
