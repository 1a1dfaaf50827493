"""Columns of the rows of comparisons and studies, as in their Parquet files: units and meanings."""

from foreride.comfort.registry import METRICS

Definition = tuple[str, str]
"""Unit ("" for none) and meaning."""

_OWN: dict[str, Definition] = {
    "key": ("", "hash of the drive within its study"),
    "error": ("", "message of a drive that failed; null otherwise"),
    "scenario": ("", "name of the scenario, or of its file in a study"),
    "vehicle": ("", "name of the car, or of its file"),
    "controller": ("", "name of the controller"),
    "perception": ("", "name of the perception"),
    "seed": ("", "seed of noise, weather and roughness"),
    "timing.wall_s": ("s", "duration of the simulation on the machine that ran it"),
    "timing.real_time_factor": ("1", "simulated time over that duration"),
    "timing.median_ms": ("ms", "median duration of a controller step"),
    "timing.max_ms": ("ms", "longest duration of a controller step"),
    "timing.look_median_ms": ("ms", "median duration of rendering and detection of an image"),
    "timing.estimator_median_ms": ("ms", "median duration of an update of the preview estimator"),
    "solver.solves": ("1", "controller steps with a valid answer"),
    "solver.fallbacks": ("1", "controller steps that a fallback replaced"),
    "solver.reasons": ("", "number of fallbacks by reason, as JSON"),
    "solver.active": ("", "number of steps by active constraint of the plan, as JSON"),
    "observer_error.rattle_m": ("m", "RMS error of the estimated suspension travel, over wheels"),
    "observer_error.rattle_velocity": ("m/s", "RMS error of its rate, over wheels"),
    "observer_error.wheel_velocity": ("m/s", "RMS error of the vertical wheel velocity, over wheels"),
    "observer_error.tyre_deflection_m": (
        "m",
        "RMS error of the tyre deflection while the wheel touches the road",
    ),
    "observer_error.damping_ns_m": ("N·s/m", "RMS error of the damper setting, over wheels"),
    "observer_error.heave_velocity": ("m/s", "RMS error of the heave velocity"),
    "observer_error.pitch_rate": ("rad/s", "RMS error of the pitch rate"),
    "observer_error.roll_rate": ("rad/s", "RMS error of the roll rate"),
    "perception_stats.frames": ("1", "exposures of the camera"),
    "perception_stats.boxes": ("1", "boxes given to the preview estimator"),
    "perception_stats.confirmed_tracks": ("1", "obstacles that the estimator confirmed"),
    "perception_stats.failed_looks": ("1", "exposures whose detection failed"),
    "perception_stats.backend": ("", "backend that ran the detector"),
    "damper_produced": ("J", "energy that the dampers supplied, an audit: 0 for a passive element"),
    "damping_outside": ("s", "time with a damper setting outside its range, an audit"),
    "actuator_energy": ("J", "energy that the actuators delivered"),
    "actuator_recovered": ("J", "energy that the actuators absorbed"),
    "actuator_power": ("W", "mean power that the actuators delivered"),
    "actuator_power_peak": ("W", "greatest power that the actuators delivered"),
    "bound.objective": ("(m/s²)²", "objective of the clairvoyant bound"),
    "bound.gap_between_starts": ("1", "relative difference of the bound's best starts"),
    "bound.passive_objective": ("(m/s²)²", "objective of the passive car on the same drive"),
}
_VARIED = "set."


def definition_of(column: str) -> Definition:
    """Unit and meaning of a column; KeyError for an unknown one."""
    if column.startswith(_VARIED):
        return "", f"value of the scenario field {column.removeprefix(_VARIED)}"
    if (metric := METRICS.find(column)) is not None:
        return metric.unit, metric.meaning
    return _OWN[column]


def definitions() -> dict[str, Definition]:
    """Unit and meaning of each column that is no metric and no varied field."""
    return dict(_OWN)
