import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from comfort import ride_metrics
from files.errors import InputError

RATE, N = 1000.0, 20_000
TIME = np.arange(N) / RATE


def signals(**changes):
    """A half car: a 4 Hz sine at both seats, rattle and tyre load sines of known RMS."""
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


def test_quarter_car_has_no_pitch():
    s = signals()
    one = {k: v[:1] for k, v in s.items() if k not in ("pitch_acc", "stop_gap_m")}
    assert ride_metrics(RATE, **one, stop_gap_m=0.08)["pitch_acc_rms"] == 0


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
        ({"stop_gap_m": 0.0}, "stop_gap_m must be > 0"),
        ({"rho": -1.0}, "rho must be >= 0"),
        ({"pitch_acc": np.zeros(3)}, "pitch_acc must have 1 rows? of"),
    ],
)
def test_bad_input_names_the_argument(change, message):
    with pytest.raises(InputError, match=message):
        ride_metrics(RATE, **signals(**change))
    with pytest.raises(InputError, match="rate must be"):
        ride_metrics(100.0, **signals())
