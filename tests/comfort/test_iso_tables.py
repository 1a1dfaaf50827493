"""Reference tables: transcription, and the test signal."""

import numpy as np
import pytest

from foreride.comfort.iso_tables import (
    BURST_INDICATIONS,
    CYCLES,
    ISO_2631_1,
    ISO_8041,
    NOMINAL_HZ,
    bands,
    sawtooth_bursts,
)


@pytest.mark.parametrize(
    ("name", "total"), [("Wk", 13966), ("Wd", 10249.0), ("Wc", 16177.4), ("We", 7443.5), ("Wj", 16887)]
)
def test_columns_add_up_to_those_of_the_printed_table(name: str, total: float) -> None:
    assert np.nansum(ISO_2631_1[name]) == pytest.approx(total, abs=1e-6)


def test_nominal_frequencies_are_the_preferred_numbers_of_third_octaves() -> None:
    """ISO 266: within 1.2 % of the powers of 10 to the tenth."""
    np.testing.assert_allclose(NOMINAL_HZ, 10.0 ** (np.arange(-3, 20) / 10.0), rtol=0.012)


@pytest.mark.parametrize("name", list(ISO_8041))
def test_factors_of_both_standards_agree_where_both_have_them(name: str) -> None:
    """Four figures of ISO 8041-1 against three of ISO 2631-1, at nominal and at true centres."""
    if name in ISO_2631_1:
        centres, factors = bands(name)
        printed = np.array(ISO_2631_1[name]) / 1000.0
        ours = np.interp(np.log(NOMINAL_HZ), np.log(centres), factors)
        np.testing.assert_allclose(ours[np.isfinite(printed)], printed[np.isfinite(printed)], rtol=0.03)


@pytest.mark.parametrize("name", list(BURST_INDICATIONS))
def test_longer_bursts_indicate_more(name: str) -> None:
    table = np.array(BURST_INDICATIONS[name])
    assert table.shape == (len(CYCLES), 4)
    assert (np.diff(table, axis=0) > 0.0).all()
    assert (table[:, 2] >= table[:, 3]).all()


@pytest.mark.parametrize(("low_frequency", "start_s", "rad_s"), [(False, 1.0, 100.0), (True, 40.0, 2.5)])
def test_a_burst_rises_through_zero_and_falls_once_a_cycle(
    low_frequency: bool, start_s: float, rad_s: float
) -> None:
    rate, cycles = 2000.0 / start_s, 2
    acc = sawtooth_bursts(cycles, rate, low_frequency)
    time = np.arange(len(acc)) / rate
    assert len(acc) == round(60 * start_s * rate)
    period_s = 2 * np.pi / rad_s
    assert not acc[time < start_s].any()
    first = (time > start_s) & (time < start_s + 0.49 * period_s)
    np.testing.assert_allclose(acc[first], 2.0 * (time[first] - start_s) / period_s, atol=1e-9)
    assert acc.max() == pytest.approx(1.0, abs=0.04)
    assert acc.min() == pytest.approx(-1.0, abs=0.04)
    bursts = np.flatnonzero(np.diff((np.abs(acc) > 0).astype(int)) == 1)
    ends = time[np.abs(acc) > 0]
    assert ends[ends < 10 * start_s][-1] == pytest.approx(start_s + cycles * period_s, abs=0.02 * period_s)
    starts = time[bursts][np.diff(time[bursts], prepend=-np.inf) > 5 * start_s]
    np.testing.assert_allclose(starts, start_s * (1.0 + 10.0 * np.arange(6)), atol=2 / rate)
