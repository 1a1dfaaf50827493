"""Data augmentation keeps boxes on their objects."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from foreride.detector.data import augment
from foreride.detector.data.augment import Augmentation, training_view
from foreride.detector.data.crops import IGNORED, TrainingView
from foreride.files.errors import InputError
from tests.detector.roads import made


@given(st.integers(0, 500), st.sampled_from([0.0, 1.0]))
def test_boxes_follow_their_objects(seed: int, mosaic: float) -> None:
    with pytest.MonkeyPatch.context() as patch:
        for light in ("coloured", "shadowed", "hazy"):  # may saturate an object, or darken what is beside it
            patch.setattr(augment, light, lambda image, rng: image)
        _check_boxes(seed, mosaic)


def _check_boxes(seed: int, mosaic: float) -> None:
    samples, rng = [made(seed + i) for i in range(4)], np.random.default_rng(seed)
    image, classes, boxes = training_view(samples, seed % 4, 128, 96, rng, Augmentation(mosaic))
    assert image.shape == (96, 128, 3)
    assert image.dtype == np.uint8
    assert (boxes >= 0).all()
    assert (boxes <= [128, 96, 128, 96]).all()
    grey = image.astype(int).mean(2)
    for cls, box in zip(classes, boxes, strict=True):
        x0, y0, x1, y1 = box
        if cls == IGNORED or y1 - y0 < 5 or x1 - x0 < 8:
            continue
        inside = grey[int(y0) + 2 : int(y1) - 1, int(x0) + 2 : int(x1) - 1].mean()
        middle = np.median(grey)
        assert inside > middle if cls == 0 else inside < middle


def test_views_repeat_with_their_seed() -> None:
    samples, how = [made(3), made(4)], Augmentation(0.5, 0.5, 0.5)
    one, two = (training_view(samples, 0, 128, 96, np.random.default_rng(7), how) for _ in range(2))
    assert all(np.array_equal(a, b) for a, b in zip(one, two, strict=True))


@pytest.mark.parametrize(("what", "names"), [("weather", ["rain", "snow", "fog"]), ("litter", ["litter"])])
def test_what_lies_over_the_image_leaves_the_boxes(
    what: str, names: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def view() -> TrainingView:
        how = Augmentation(**{what: 1.0})
        return training_view([made(3)], 0, 128, 96, np.random.default_rng(1), how)

    def invisible(effect: Callable) -> Callable:
        """Draws the same numbers, and leaves the image as it is."""
        return lambda image, strength, rng: (effect(image, strength, rng), image)[1]

    covered = view()
    for name in names:
        monkeypatch.setattr(augment, name, invisible(getattr(augment, name)))
    clean = view()
    assert not np.array_equal(clean.image, covered.image)
    assert np.array_equal(clean.boxes, covered.boxes)
    assert np.array_equal(clean.classes, covered.classes)


def test_a_training_ends_without_mosaic() -> None:
    how = Augmentation(mosaic=0.5, weather=0.3, plain_last=0.2)
    assert how.at(0.0) == how.at(0.79) == how
    assert how.at(0.8) == how.at(1.0) == Augmentation(mosaic=0.0, weather=0.3, plain_last=0.2)
    assert Augmentation(mosaic=0.5, plain_last=0.0).at(0.999).mosaic == 0.5


@pytest.mark.parametrize("name", ["mosaic", "weather", "litter", "plain_last"])
@pytest.mark.parametrize("value", [-0.1, 1.5, float("nan")])
def test_shares_out_of_range_are_refused(name: str, value: float) -> None:
    with pytest.raises(InputError, match=rf"{name} must lie in 0 \.\.\. 1, got {value}"):
        Augmentation(**{name: value})
