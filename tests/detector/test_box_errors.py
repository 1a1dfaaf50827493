"""Tests of the error model of a detector."""

import numpy as np
import pytest

from foreride.detector.box_errors import SIMULATED_CALIBRATION, BoxErrors, degrade
from foreride.detector.calibration import DEFAULT_CALIBRATION
from foreride.detector.detections import Detections
from foreride.files.errors import InputError

SIZE_PX = (640, 384)


def many(errors, count=4000, seed=1):
    rng = np.random.default_rng(seed)
    found = Detections([[200.0, 220.0, 400.0, 260.0]], [1.0], [0])
    return [degrade(found, SIZE_PX, errors, rng) for _ in range(count)]


def test_noise_bias_and_misses_are_as_asked():
    seen = many(
        BoxErrors(pixel_sigma=1.5, bottom_bias_px=(2.0, 2.0), top_bias_px=(-1.0, -1.0), miss_probability=0.2)
    )
    boxes = np.concatenate([found.boxes for found in seen])
    assert 1 - len(boxes) / len(seen) == pytest.approx(0.2, abs=0.02)
    np.testing.assert_allclose(boxes.mean(axis=0), [200.0, 219.0, 400.0, 262.0], atol=0.15)
    np.testing.assert_allclose(boxes.std(axis=0), 1.5, rtol=0.05)


def test_false_boxes_come_at_their_rate():
    seen = many(BoxErrors(miss_probability=0.999, false_per_frame=0.3))
    assert np.mean([len(found) for found in seen]) == pytest.approx(0.3, abs=0.03)


def test_the_same_seed_gives_the_same_boxes():
    a, b = (many(BoxErrors(false_per_frame=0.5), 20, seed=7) for _ in range(2))
    for first, second in zip(a, b, strict=True):
        np.testing.assert_array_equal(first.boxes, second.boxes)


def test_edges_cut_by_the_image_stay_cut():
    rng = np.random.default_rng(0)
    found = Detections([[0.0, 300.0, 640.0, 384.0]], [1.0], [0])
    boxes = degrade(found, SIZE_PX, BoxErrors(miss_probability=0.0), rng).boxes
    np.testing.assert_array_equal(boxes[0, [0, 2, 3]], [0.0, 640.0, 384.0])


@pytest.mark.parametrize(
    ("field", "value"), [("pixel_sigma", -1.0), ("miss_probability", 1.0), ("range_m", 0.0)]
)
def test_refuses_impossible_errors(field, value):
    with pytest.raises(InputError, match=field):
        BoxErrors(**{field: value})


def test_the_default_bias_is_that_of_the_simulated_calibration() -> None:
    assert BoxErrors().top_bias_px == tuple(one.top_bias_px for one in SIMULATED_CALIBRATION)
    assert BoxErrors().bottom_bias_px == tuple(one.bottom_bias_px for one in SIMULATED_CALIBRATION)
    assert len(SIMULATED_CALIBRATION) == len(DEFAULT_CALIBRATION)
