"""Image sensor: exposure, noise and occlusion by the bonnet."""

import numpy as np
import pytest

from foreride.road.render.appearance import Appearance
from foreride.road.render.optics import image_sensor


def developed(level: float, **look: float) -> np.ndarray:
    image = np.full((64, 96, 3), level, np.float32)
    rng = np.random.default_rng(0)
    pool = image_sensor.noise_pool(np.random.default_rng(1))
    return image_sensor.develop(image, Appearance(**look), 1.0, pool, rng, image_sensor.tone_curve())  # type: ignore[arg-type]


def test_tone_curve_rises_from_black_to_white() -> None:
    curve = image_sensor.tone_curve().astype(int)
    assert curve[0] == 0
    assert curve[-1] >= 254
    assert (np.diff(curve) >= 0).all()


def test_filled_rows_have_the_colour_of_each_channel() -> None:
    image = np.zeros((4, 5, 3), np.float32)
    image_sensor.fill_rows(image[:2], np.array([0.1, 0.2, 0.3]))
    assert (image[:2] == np.float32([0.1, 0.2, 0.3])).all()
    assert (image[2:] == 0).all()


def test_no_noise_gives_a_flat_image() -> None:
    assert np.ptp(developed(0.3, noise=0.0)) == 0


def test_noise_grows_with_its_parameter_and_is_centred() -> None:
    clean = float(developed(0.3, noise=0.0).mean())
    spread = [developed(0.3, noise=n).std() for n in (0.005, 0.02)]
    assert spread[1] > 2.5 * spread[0] > 0
    assert developed(0.3, noise=0.02).mean() == pytest.approx(clean, abs=1.0)


def test_warmth_moves_red_against_blue() -> None:
    pixel = developed(0.3, noise=0.0, warmth=0.1)[0, 0].astype(int)
    assert pixel[0] > pixel[1] > pixel[2]


def test_bonnet_covers_its_share_in_the_middle() -> None:
    rows = image_sensor.bonnet_row(Appearance(bonnet=0.1), 641, 400)
    assert rows[320] == 360
    assert rows[0] > rows[320]
    assert (image_sensor.bonnet_row(Appearance(), 64, 48) == 48).all()
