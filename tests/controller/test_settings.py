"""Defaults of the controllers' settings: the values that the documentation's tables were made with."""

import pytest

from foreride.controller.settings import ControllerSettings, GateSettings, RoadSettings, SkyhookSettings
from foreride.controller.speed.settings import PreviewPlanner, ReactiveBraking
from foreride.files.errors import InputError
from foreride.files.reading import strict

TWO_STATE = {"hard_ns_m": 4500.0, "soft_ns_m": 300.0}
FIXED = {"front_ns_m": 1500.0, "rear_ns_m": 1500.0}
ROAD = {
    "uncertainty": "early", "sigmas_early": 1.0, "known_m": 0.15, "unknown_m": 0.3, "height_sigmas": 0.35,
    "credibility": 0.95, "blend_m": 0.2, "slope_decay_s": 0.01,
}  # fmt: skip
MPC = {
    "horizon_s": 0.6, "blind_horizon_s": 0.2, "fine_s": 0.05, "rho": 3.0, "input_weight": 1e-3,
    "move_weight": 0.0, "adapts": True, "force": {"weight": 1e-3, "rate_n_s": 1e6, "power_w": 5000.0},
    "limits": {"unloading": None, "travel": None, "penalty": 50.0}, "road": ROAD,
}  # fmt: skip
GATE = {
    "reach_m": 0.06, "widest_m": 0.15, "height_m": 0.008, "gain": 0.2, "least_gain": 0.3, "strike_m": 0.01,
    "aside_m": 1.0, "correlation": 0.4, "memory_m": 3.0, "half_life_s": 10.0, "lost": 0.6, "regained": 0.8,
}  # fmt: skip
SMOOTHED = {"floor_ns_m": 300.0, "smoothing_m_s": 0.1}
DEFAULTS = {
    "passive": {"damping_ns_m": None},
    "fixed": FIXED,
    "fixed_best": FIXED,
    "skyhook": {"sky_ns_m": 4500.0, "ground_ns_m": 130.0, **SMOOTHED},
    "skyhook2": TWO_STATE,
    "groundhook": TWO_STATE,
    "hybrid": {"gain_ns_m": 3000.0, "alpha": 0.5, **SMOOTHED},
    "add": TWO_STATE,
    "sh_add": {**TWO_STATE, "crossover_hz": 1.8},
    "pdd": TWO_STATE,
    "lqr_clipped": {"nominal_ns_m": 1000.0, "rho": 3.0, "force_weight": 0.1, "smoothing_m_s": 0.1},
    "mpc": MPC,
    "supervisor": {
        "reactive": "skyhook", "stale_s": 0.5, "highest_m": 0.4, "transfer_s": 0.005, "gate": GATE,
    },
    "user": {},
}  # fmt: skip
LIMITS = {"min_kmh": 10.0, "max_deceleration_m_s2": 3.0, "max_acceleration_m_s2": 2.0, "max_jerk_m_s3": 5.0}


def test_what_a_scenario_leaves_out_is_as_documented() -> None:
    assert strict.to_mapping(ControllerSettings()) == DEFAULTS


def test_what_a_speed_planner_leaves_out_is_as_documented() -> None:
    preview, reactive = (
        {name: value for name, value in vars(kind()).items() if name != "kind"}
        for kind in (PreviewPlanner, ReactiveBraking)
    )
    assert preview == LIMITS | {"time_weight": 0.2, "sight_m": 30.0, "longitudinal_weight": 0.05}
    assert reactive == LIMITS | {"comfortable_m_s2": 0.8, "memory_s": 0.5}


def test_a_hysteresis_and_a_ramp_must_have_a_width() -> None:
    with pytest.raises(InputError, match=r"lost must be < 0.8, regained, got 0.8"):
        GateSettings(lost=0.8)
    with pytest.raises(InputError, match=r"known_m must be < 0.3, unknown_m, got 0.3"):
        RoadSettings(known_m=0.3)


def test_no_damping_is_a_setting() -> None:
    assert SkyhookSettings(sky_ns_m=0.0, ground_ns_m=0.0, floor_ns_m=0.0).sky_ns_m == 0.0
