import json

import cv2
import numpy as np
import pytest
import yaml

from foreride.files.reading import strict
from foreride.road.camera.pinhole import Camera
from foreride.scenarios.cli import main
from foreride.scenarios.definition.schema import CameraSetup
from tests.road.boards import photograph, poses

TRUE = Camera(focal_px=500.0, distortion=(-0.2, 0.05, 0.0, 0.0, 0.0))


@pytest.fixture(scope="module")
def photos(tmp_path_factory):
    folder = tmp_path_factory.mktemp("photos")
    paths = [folder / f"{number}.png" for number in range(6)]
    for path, pose in zip(paths, poses(6, np.random.default_rng(1)), strict=True):
        cv2.imwrite(str(path), photograph(TRUE, *pose))
    return [str(path) for path in paths]


def test_photos_give_the_camera_block_of_a_scenario(photos, tmp_path, capsys):
    out, numbers = tmp_path / "camera.yaml", tmp_path / "camera.json"
    options = ["--squares", "9x6", "--square_m", "0.03", "--out", str(out), "--json", str(numbers)]
    assert main(["calibrate", *photos, *options]) == 0
    setup = strict.structure(CameraSetup, yaml.safe_load(out.read_text())["camera"], str(out))
    assert setup.intrinsics.focal_px == pytest.approx(500.0, rel=0.01)
    assert setup.intrinsics.distortion[0] == pytest.approx(-0.2, abs=0.03)
    told = json.loads(numbers.read_text())
    assert told["rms_px"] < 0.2
    assert f"{told['rms_px']:.3f} px (RMS)" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--squares", "9", "--square_m", "0.03"], "--squares must be like 9x6"),
        (["--squares", "9x6", "--square_m", "3"], "--square_m must lie in"),
        (["--squares", "9x6", "--square_m", "0.03"], "was found in 0 of 1 photographs"),
    ],
)
def test_what_cannot_be_is_told_in_one_line(options, message, tmp_path, capsys):
    blank = tmp_path / "blank.png"
    cv2.imwrite(str(blank), np.full((96, 160), 128, np.uint8))
    out = tmp_path / "camera.yaml"
    assert main(["calibrate", str(blank), *options, "--out", str(out)]) == 2
    assert message in capsys.readouterr().err
    assert not out.exists()


def test_no_image_and_another_size_are_named(photos, tmp_path, capsys):
    options = ["--squares", "9x6", "--square_m", "0.03"]
    text, small = tmp_path / "text.png", tmp_path / "small.png"
    text.write_text("no image")
    cv2.imwrite(str(small), np.zeros((96, 160), np.uint8))
    for path, message in ((text, "cannot be decoded"), (small, "is 160x96 px; must be 640x384 px")):
        assert main(["calibrate", photos[0], str(path), *options]) == 2
        assert f"{path}: {message}" in capsys.readouterr().err
