import numpy as np
import pytest

from foreride.controller.interface import Timing
from foreride.controller.mpc.command_delay import CommandDelayLine


def command(value: float) -> np.ndarray:
    return np.array([value])


def told(pipeline: CommandDelayLine) -> list[tuple[float, float, float]]:
    return [(round(h.start_s, 9), round(h.duration_s, 9), float(h.command[0])) for h in pipeline.pending()]


def test_without_delay_nothing_is_on_its_way() -> None:
    pipeline = CommandDelayLine(Timing(0.01, 0.0), command(1.5))
    pipeline.issue(command(2.0))
    assert told(pipeline) == []


def test_a_delay_of_two_and_a_half_periods_passes_three_commands() -> None:
    """Period 10 ms, delay 25 ms: at t = 0 the command of −30 ms acts, then the later ones."""
    pipeline = CommandDelayLine(Timing(0.01, 0.025), command(1.5))
    assert told(pipeline) == [(0.0, 0.005, 1.5), (0.005, 0.01, 1.5), (0.015, 0.01, 1.5)]
    for value in (1.0, 2.0, 3.0, 4.0):
        pipeline.issue(command(value))
    assert told(pipeline) == [(0.0, 0.005, 2.0), (0.005, 0.01, 3.0), (0.015, 0.01, 4.0)]


@pytest.mark.parametrize("delay_s", [0.003, 0.01, 0.02, 0.05])
def test_the_stretches_fill_the_delay_without_gap(delay_s: float) -> None:
    holds = CommandDelayLine(Timing(0.01, delay_s), command(1.5)).pending()
    ends = [hold.start_s + hold.duration_s for hold in holds]
    assert holds[0].start_s == 0.0
    np.testing.assert_allclose([hold.start_s for hold in holds[1:]], ends[:-1])
    assert ends[-1] == pytest.approx(delay_s)


def test_reset_puts_the_first_command_back() -> None:
    pipeline = CommandDelayLine(Timing(0.01, 0.01), command(1.5))
    pipeline.issue(command(2.0))
    pipeline.reset()
    assert told(pipeline) == [(0.0, 0.01, 1.5)]


def test_a_longer_delay_that_turns_out_later_finds_the_earlier_commands() -> None:
    pipeline = CommandDelayLine(Timing(0.01, 0.0), command(1.5), longest_s=0.03)
    for value in (1.0, 2.0, 3.0, 4.0):
        pipeline.issue(command(value))
    assert told(pipeline) == []
    pipeline.delay_s = 0.015
    assert told(pipeline) == [(0.0, 0.005, 3.0), (0.005, 0.01, 4.0)]
    pipeline.reset()
    assert told(pipeline) == []
