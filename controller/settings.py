"""What can be set about each controller; a scenario's `control.settings` is a `ControllerSettings`."""

from dataclasses import dataclass, field
from math import inf, isfinite

from files.errors import InputError


@dataclass(frozen=True)
class PassiveSettings:
    """damping_ns_m: one coefficient for every wheel; None takes the vehicle's own passive coefficients."""

    damping_ns_m: float | None = None


@dataclass(frozen=True)
class SkyhookSettings:
    """The imagined dampers of the skyhook family.

    sky_ns_m: between body and sky. ground_ns_m: between wheel and ground.
    floor_ns_m: damping where the law asks for less.
    smoothing_m_s: suspension velocity under which the law fades to the floor, so noise cannot chatter it.
    """

    sky_ns_m: float = 4500.0
    ground_ns_m: float = 130.0
    floor_ns_m: float = 300.0
    smoothing_m_s: float = 0.1

    def __post_init__(self) -> None:
        _within("sky_ns_m", self.sky_ns_m, 0.0, inf)
        _within("ground_ns_m", self.ground_ns_m, 0.0, inf)
        _within("floor_ns_m", self.floor_ns_m, 0.0, inf)
        _within("smoothing_m_s", self.smoothing_m_s, 1e-4, 1.0)


@dataclass(frozen=True)
class RoadSettings:
    """How preview and measurement become one road.

    sigmas_early: by how many standard deviations of their position features are taken to come earlier, as
    late preparation costs more than early.
    slope_decay_s: time in which a measured slope that the preview does not explain fades away.
    """

    sigmas_early: float = 1.0
    slope_decay_s: float = 0.01

    def __post_init__(self) -> None:
        _within("sigmas_early", self.sigmas_early, 0.0, 3.0)
        _within("slope_decay_s", self.slope_decay_s, 1e-4, 1.0)


@dataclass(frozen=True)
class MpcSettings:
    """Horizon and cost of the model predictive controllers.

    horizon_s: length of the plan; its intervals are the control period.
    rho: (m/s²)², weight of the relative tyre load, as in the objective J.
    input_weight: of (c − 1)², c in kN·s/m; keeps the plan definite where nothing moves.
    patience: failed solves in a row that the last good plan bridges.
    road: how preview and measurement become one road.
    """

    horizon_s: float = 0.2
    rho: float = 3.0
    input_weight: float = 1e-3
    patience: int = 3
    road: RoadSettings = field(default_factory=RoadSettings)

    def __post_init__(self) -> None:
        _within("horizon_s", self.horizon_s, 0.02, 1.0)
        _within("rho", self.rho, 0.0, 1e3)
        _within("input_weight", self.input_weight, 1e-9, 1e9)
        _within("patience", self.patience, 0, 1000)


@dataclass(frozen=True)
class ControllerSettings:
    """Settings of all controllers, of which each takes its own.

    user: keyword arguments of a controller of the user's own.
    """

    passive: PassiveSettings = field(default_factory=PassiveSettings)
    skyhook: SkyhookSettings = field(default_factory=SkyhookSettings)
    mpc: MpcSettings = field(default_factory=MpcSettings)
    user: dict[str, float] = field(default_factory=dict)


def _within(name: str, value: float, low: float, high: float) -> None:
    if not (isfinite(value) and low <= value <= high):
        allowed = f"lie in {low:g} ... {high:g}" if isfinite(high) else f"be finite and >= {low:g}"
        raise InputError(f"{name} must {allowed}, got {value:g}")
