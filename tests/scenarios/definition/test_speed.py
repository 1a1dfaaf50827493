import numpy as np
import pytest

from foreride.files.errors import InputError
from foreride.scenarios.definition.speed import SpeedPoint, profile


def test_points_by_place_and_by_time() -> None:
    motion = profile(
        36.0, 0.0, [SpeedPoint(36.0, at_m=20.0), SpeedPoint(18.0, at_m=35.0), SpeedPoint(36.0, at_s=7.0)]
    )
    np.testing.assert_allclose(motion.times_s, [0.0, 2.0, 4.0, 7.0])
    np.testing.assert_allclose(motion.speeds_m_s, [10.0, 10.0, 5.0, 10.0])


@pytest.mark.parametrize(
    ("points", "told"),
    [
        ([SpeedPoint(20.0, at_s=2.0), SpeedPoint(30.0, at_s=1.0)], r"speed\[1\] must come after"),
        ([SpeedPoint(0.0, at_m=1.0)], r"speed\[0\] must need at most 12 m/s²"),
        ([SpeedPoint(0.0, at_s=5.0)], r"speed\[0\] must not stop the car"),
    ],
)
def test_impossible_points_are_told(points: list[SpeedPoint], told: str) -> None:
    with pytest.raises(InputError, match=told):
        profile(36.0, 0.0, points)


def test_a_point_has_one_place() -> None:
    with pytest.raises(InputError, match="at_s must be given, or at_m"):
        SpeedPoint(30.0)
