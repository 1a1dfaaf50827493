"""Training stages and learning rate."""

import pytest

from foreride.detector.training.schedule import (
    Stage,
    parse_stages,
    rate_factor,
    stage_at,
    total_passes,
    work_done,
)
from foreride.files.errors import InputError

STAGES = parse_stages("320x192:100, 640x384:50")


def test_parses_and_prints_stages() -> None:
    assert (Stage(320, 192, 100), Stage(640, 384, 50)) == STAGES
    assert ",".join(map(str, STAGES)) == "320x192:100,640x384:50"
    assert total_passes(STAGES) == 150


@pytest.mark.parametrize("text", ["", "320x192", "320x192:0", "330x192:5", "320x0:5", "320x192:5,x"])
def test_refuses_bad_stages(text: str) -> None:
    with pytest.raises(InputError, match="--stages"):
        parse_stages(text)


def test_stage_under_way() -> None:
    assert [stage_at(STAGES, n).width for n in (0, 99, 100, 149, 150)] == [320, 320, 640, 640, 640]


def test_work_is_counted_in_pixels() -> None:
    # 100 passes of a quarter of the pixels and 50 of all: 25 against 50
    assert work_done(STAGES, 100) == pytest.approx(25 / 75)
    assert [work_done(STAGES, n) for n in (0, 150, 999)] == [0, 1, 1]


def test_rate_warms_up_and_decays_to_its_floor() -> None:
    assert rate_factor(STAGES, 0, warmup=10) == pytest.approx(0.1)
    assert rate_factor(STAGES, 150, warmup=10) == pytest.approx(0.01)
    rates = [rate_factor(STAGES, n, warmup=10) for n in range(10, 151)]
    assert rates == sorted(rates, reverse=True)


def test_cosine_decay_is_level_at_both_ends() -> None:
    steps = parse_stages("96x64:1000")
    rates = [rate_factor(steps, n, warmup=1, decay="cosine") for n in (0, 10, 500, 990, 1000)]
    assert rates[0] == 1
    assert rates[2] == pytest.approx(0.505)  # half way between the peak and the floor of 0.01
    assert rates[4] == pytest.approx(0.01)
    assert rates[0] - rates[1] < 3e-4
    assert rates[3] - rates[4] < 3e-4


def test_a_short_training_leaves_its_warm_up() -> None:
    """A warm-up longer than the training would keep the rate far below its peak."""
    short = parse_stages("64x64:100")
    assert rate_factor(short, 10, warmup=2000) == pytest.approx(0.01 + 0.99 * 0.9)
    assert max(rate_factor(short, n, warmup=2000) for n in range(100)) > 0.85
