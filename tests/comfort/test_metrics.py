import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from foreride.comfort import METRICS, SeatedPerson, axis_values, body_motion, ride_metrics, total_value
from foreride.files.errors import InputError

RATE, N = 1000.0, 20_000
TIME = np.arange(N) / RATE


def signals(**changes):
    """Half-car signals: a 4 Hz sine at both seats, rattle and tyre load sines of known RMS."""
    wave = np.sin(2 * np.pi * 4 * TIME)
    base = {
        "seat_acc": np.stack([2 * wave, 1 * wave]),
        "pitch_acc": 0.5 * wave,
        "rattle": np.stack([0.03 * wave, 0.01 * wave]),
        "tyre_force": np.stack([4000 + 400 * wave, 3000 + 600 * wave]),
        "static_tyre_force": (4000.0, 3000.0),
        "damper_power": np.stack([np.full(N, 20.0), np.full(N, 5.0)]),
        "stop_gap_m": 0.08,
    }
    return base | changes


def test_closed_form_of_sines():
    m = ride_metrics(RATE, **signals())
    mean_square = 0.967**2 * (4 + 1) / 2 / 2
    load_square = (0.1**2 + 0.2**2) / 2 / 2
    assert m["wk_rms"] == pytest.approx(np.sqrt(mean_square), rel=5e-3)
    assert m["vdv"] == pytest.approx(2 * 0.967 * (3 / 8 * 20) ** 0.25, rel=5e-3)
    assert m["mtvv"] == pytest.approx(2 * 0.967 / np.sqrt(2), rel=3e-2)
    assert m["peak_acc"] == pytest.approx(2, rel=1e-3)
    assert m["pitch_acc_rms"] == pytest.approx(0.5 / np.sqrt(2))
    assert m["rattle_rms"] == pytest.approx(np.sqrt((0.03**2 + 0.01**2) / 4))
    assert m["rattle_peak"] == pytest.approx(0.03, rel=1e-3)
    assert m["tyre_load_rms"] == pytest.approx(np.sqrt(load_square))
    assert m["damper_energy"] == pytest.approx(25 * 20)
    assert m["stop_time"] == m["lift_time"] == 0
    assert m["objective"] == pytest.approx(mean_square + 3 * load_square, rel=1e-2)


def test_rho_is_the_weight_of_tyre_load():
    plain, heavy = (ride_metrics(RATE, **signals(), rho=rho) for rho in (0.0, 10.0))
    assert plain["objective"] == pytest.approx(plain["wk_rms"] ** 2)
    assert heavy["objective"] - plain["objective"] == pytest.approx(10 * plain["tyre_load_rms"] ** 2)


def test_times_count_moments_in_which_any_wheel_is_affected():
    rattle, force = np.zeros((2, N)), np.full((2, N), 3000.0)
    rattle[0, 100:200], rattle[1, 150:250] = 0.081, -0.09
    force[0, 0:30], force[1, 1000:1020] = 0.0, 0.0
    m = ride_metrics(RATE, **signals(rattle=rattle, tyre_force=force, static_tyre_force=(3000.0, 3000.0)))
    assert m["stop_time"] == pytest.approx(0.150)
    assert m["lift_time"] == pytest.approx(0.050)


def test_bump_and_rebound_stops_may_differ():
    rattle = np.zeros((2, N))
    rattle[0, 100:200], rattle[1, 500:560] = -0.06, 0.06
    m = ride_metrics(RATE, **signals(rattle=rattle, stop_gap_m=(0.05, 0.07), rebound_gap_m=0.1))
    assert m["stop_time"] == pytest.approx(0.1)
    m = ride_metrics(RATE, **signals(rattle=rattle, stop_gap_m=0.1, rebound_gap_m=(0.1, 0.05)))
    assert m["stop_time"] == pytest.approx(0.06)


def quarter(s):
    return {k: v[:1] for k, v in s.items() if k not in ("pitch_acc", "stop_gap_m")} | {"stop_gap_m": 0.08}


def test_quarter_car_has_neither_pitch_nor_roll():
    m = ride_metrics(RATE, **quarter(signals()))
    assert m["pitch_acc_rms"] == m["roll_acc_rms"] == 0


def test_every_metric_is_described():
    assert list(ride_metrics(RATE, **signals())) == list(METRICS.own)


def test_tyre_load_percentile_and_peak_power():
    force = np.full((2, N), 3000.0)
    force[1, : N // 10] = 1500.0
    power = np.zeros((2, N))
    power[1, 7] = 900.0
    static = (3000.0, 3000.0)
    m = ride_metrics(RATE, **signals(tyre_force=force, static_tyre_force=static, damper_power=power))
    assert m["tyre_load_p95"] == pytest.approx(0.5)
    assert m["damper_power_peak"] == 900
    assert m["damper_energy"] == pytest.approx(0.9)


def test_total_value_is_that_of_the_worst_seat():
    """Each seat's vertical acceleration with the body's rotations, at the height of the centre of gravity."""
    wave = np.sin(2 * np.pi * 6 * TIME)
    seats, pitch, roll = np.stack([wave, 2 * wave]), 3 * wave, 1.5 * wave
    m = ride_metrics(RATE, **signals(seat_acc=seats, pitch_acc=pitch, roll_acc=roll))
    expected = total_value(axis_values(RATE, SeatedPerson.at(0.0), *body_motion(2 * wave, pitch, roll)))
    assert m["vibration_total"] == pytest.approx(float(expected), rel=1e-12)
    assert m["vibration_total"] > m["wk_rms"]


def test_many_runs_at_once_give_what_each_gives_alone():
    rng = np.random.default_rng(1)
    four = {
        "seat_acc": rng.normal(size=(3, 4, 2000)),
        "rattle": 0.03 * rng.normal(size=(3, 4, 2000)),
        "tyre_force": np.maximum(4000 + 2000 * rng.normal(size=(3, 4, 2000)), 0),
        "damper_power": 100 * rng.normal(size=(3, 4, 2000)),
        "pitch_acc": rng.normal(size=(3, 2000)),
        "roll_acc": rng.normal(size=(3, 2000)),
    }
    fixed = {"static_tyre_force": (4000.0, 4100.0, 3000.0, 3100.0), "stop_gap_m": 0.05, "rebound_gap_m": 0.06}
    together = ride_metrics(RATE, **four, **fixed)
    for run in range(3):
        alone = ride_metrics(RATE, **{name: signal[run] for name, signal in four.items()}, **fixed)
        for name, value in alone.items():
            assert together[name].shape == (3,)
            assert together[name][run] == pytest.approx(value, rel=1e-12), name


def test_car_at_rest_scores_zero_everywhere():
    zero = np.zeros((2, N))
    rest = signals(
        seat_acc=zero,
        pitch_acc=zero[0],
        rattle=zero,
        tyre_force=np.full((N, 2), (4000.0, 3000.0)).T,
        damper_power=zero,
    )
    assert set(ride_metrics(RATE, **rest).values()) == {0.0}


@given(scale=st.floats(0.1, 10))
def test_comfort_is_homogeneous_and_the_objective_quadratic(scale):
    s = signals()
    short = {k: v[..., :2000] for k, v in s.items() if isinstance(v, np.ndarray)}
    static = np.array(s["static_tyre_force"])[:, None]
    fixed = {"static_tyre_force": s["static_tyre_force"], "stop_gap_m": 0.08}
    scaled = {k: scale * v for k, v in short.items()}
    scaled["tyre_force"] = static + scale * (short["tyre_force"] - static)
    base, more = ride_metrics(RATE, **short, **fixed), ride_metrics(RATE, **scaled, **fixed)
    for name in ("wk_rms", "vdv", "mtvv", "peak_acc", "pitch_acc_rms", "rattle_rms", "tyre_load_rms"):
        assert more[name] == pytest.approx(scale * base[name], rel=1e-9)
    assert more["objective"] == pytest.approx(scale**2 * base["objective"], rel=1e-9)
    assert more["crest_factor"] == pytest.approx(base["crest_factor"], rel=1e-9)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"seat_acc": np.zeros(N)}, "seat_acc must have shape"),
        ({"rattle": np.zeros((2, 5))}, "rattle must have any number of rows of 20000 samples"),
        ({"tyre_force": np.zeros((1, N))}, "tyre_force must have 2 rows"),
        ({"damper_power": np.full((2, N), np.inf)}, "damper_power must be finite"),
        ({"static_tyre_force": (1.0, 0.0)}, "static_tyre_force must be 2 values > 0"),
        ({"static_tyre_force": 3000.0}, "static_tyre_force must be 2 values > 0"),
        ({"stop_gap_m": 0.0}, "stop_gap_m must be 2 values > 0"),
        ({"rebound_gap_m": (0.1, -0.1)}, "rebound_gap_m must be 2 values > 0"),
        ({"rho": -1.0}, "rho must be >= 0"),
        ({"roll_acc": np.full(N, np.nan)}, "roll_acc must be 20000 finite samples"),
        ({"seat_acc": np.zeros((3, 2, N))}, "rattle must have 3 runs of any number of rows of 20000 samples"),
        ({"pitch_acc": np.zeros(3)}, "pitch_acc must be 20000 finite samples, got shape"),
    ],
)
def test_bad_input_names_the_argument(change, message):
    with pytest.raises(InputError, match=message):
        ride_metrics(RATE, **signals(**change))
    with pytest.raises(InputError, match="rate must be"):
        ride_metrics(100.0, **signals())


def test_rotations_are_given_by_their_root_mean_squares():
    wave = np.sin(2 * np.pi * 6 * TIME)
    m = ride_metrics(RATE, **signals(pitch_acc=0.5 * wave, roll_acc=3.0 * wave))
    assert (m["pitch_acc_rms"], m["roll_acc_rms"]) == pytest.approx((0.5 / 2**0.5, 3.0 / 2**0.5))
