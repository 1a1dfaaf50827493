from math import ceil

from hypothesis import given
from hypothesis import strategies as st

from foreride.scenarios.definition.clock import TICKS_PER_SECOND, due, next_due, ticks


@given(st.integers(1, 1000))
def test_a_rate_fires_that_often_each_second_and_on_time(rate_hz: int) -> None:
    fired = [tick for tick in range(3 * TICKS_PER_SECOND) if due(tick, rate_hz)]
    assert fired == [ceil(k * TICKS_PER_SECOND / rate_hz) for k in range(3 * rate_hz)]


def test_durations_round_to_the_nearest_tick() -> None:
    assert ticks(0.05) == 50
    assert ticks(0.0084) == 8


@given(st.integers(1, 1000), st.integers(0, 5000))
def test_the_next_firing_is_the_first_due_tick_ahead(rate_hz: int, tick: int) -> None:
    following = next_due(tick, rate_hz)
    assert due(following, rate_hz)
    assert not any(due(between, rate_hz) for between in range(tick + 1, following))
