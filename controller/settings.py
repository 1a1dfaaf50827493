"""What can be set about each controller; a scenario's `control.settings` is a `ControllerSettings`."""

from dataclasses import dataclass, field
from math import inf, isfinite
from typing import Literal

from files.errors import InputError


@dataclass(frozen=True)
class PassiveSettings:
    """damping_ns_m: one coefficient for every wheel; None takes the vehicle's own passive coefficients."""

    damping_ns_m: float | None = None


@dataclass(frozen=True)
class FixedSettings:
    """Constant damping by axle; wheels at or ahead of the centre of gravity are front wheels."""

    front_ns_m: float = 1500.0
    rear_ns_m: float = 1500.0

    def __post_init__(self) -> None:
        _within("front_ns_m", self.front_ns_m, 0.0, inf)
        _within("rear_ns_m", self.rear_ns_m, 0.0, inf)


@dataclass(frozen=True)
class TwoStateSettings:
    """Damping of the laws that know hard and soft, as far as the dampers can do it."""

    hard_ns_m: float = 4500.0
    soft_ns_m: float = 300.0

    def __post_init__(self) -> None:
        _hard_and_soft(self.hard_ns_m, self.soft_ns_m)


@dataclass(frozen=True)
class ShAddSettings:
    """Mixed skyhook and acceleration-driven damping: skyhook below `crossover_hz`."""

    hard_ns_m: float = 4500.0
    soft_ns_m: float = 300.0
    crossover_hz: float = 1.8

    def __post_init__(self) -> None:
        _hard_and_soft(self.hard_ns_m, self.soft_ns_m)
        _within("crossover_hz", self.crossover_hz, 0.0, 100.0)


@dataclass(frozen=True)
class HybridSettings:
    """alpha: share of skyhook, the rest is groundhook. gain_ns_m: of both. The rest as skyhook's."""

    gain_ns_m: float = 3000.0
    alpha: float = 0.5
    floor_ns_m: float = 300.0
    smoothing_m_s: float = 0.1

    def __post_init__(self) -> None:
        _within("gain_ns_m", self.gain_ns_m, 0.0, inf)
        _within("alpha", self.alpha, 0.0, 1.0)
        _within("floor_ns_m", self.floor_ns_m, 0.0, inf)
        _within("smoothing_m_s", self.smoothing_m_s, 1e-4, 1.0)


@dataclass(frozen=True)
class LqrSettings:
    """The clipped linear-quadratic regulator.

    nominal_ns_m: damping around which the car is linear. rho: (m/s²)², weight of the relative tyre load.
    force_weight: of (force in kN)². smoothing_m_s: as skyhook's.
    """

    nominal_ns_m: float = 1000.0
    rho: float = 3.0
    force_weight: float = 0.1
    smoothing_m_s: float = 0.1

    def __post_init__(self) -> None:
        _within("nominal_ns_m", self.nominal_ns_m, 0.0, 1e5)
        _within("rho", self.rho, 0.0, 1e3)
        _within("force_weight", self.force_weight, 1e-6, 1e6)
        _within("smoothing_m_s", self.smoothing_m_s, 1e-4, 1.0)


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

    uncertainty: what is done about a feature whose place or existence is not certain. "early" takes it to
    come earlier and lower, "blend" only lower, the less is known the lower, "scenarios" plans for several
    roads at once, each with its probability.
    sigmas_early: by how many standard deviations of their position "early" takes features to come earlier, as
    late preparation costs more than early.
    blend_m: standard deviation at which "blend" believes half of a feature's height.
    slope_decay_s: time in which a measured slope that the preview does not explain fades away.
    """

    uncertainty: Literal["early", "blend", "scenarios"] = "early"
    sigmas_early: float = 1.0
    blend_m: float = 0.2
    slope_decay_s: float = 0.01

    def __post_init__(self) -> None:
        _within("sigmas_early", self.sigmas_early, 0.0, 3.0)
        _within("blend_m", self.blend_m, 1e-3, 10.0)
        _within("slope_decay_s", self.slope_decay_s, 1e-4, 1.0)


@dataclass(frozen=True)
class ForceSettings:
    """What a predictive controller may ask of actuators beside the dampers, within their greatest force.

    weight: of the square of a force in kN. rate_n_s: how fast a force may change; the default leaves that to
    the actuator's lag. power_w: most that a force may deliver at the rate at which its strut is expected to
    move.
    """

    weight: float = 1e-3
    rate_n_s: float = 1e6
    power_w: float = 5000.0

    def __post_init__(self) -> None:
        _within("weight", self.weight, 1e-9, 1e9)
        _within("rate_n_s", self.rate_n_s, 1.0, 1e9)
        _within("power_w", self.power_w, 1.0, 1e9)


@dataclass(frozen=True)
class MpcSettings:
    """Horizon and cost of the model predictive controllers.

    horizon_s: length of the plan of a controller that sees ahead.
    blind_horizon_s: of one that does not; the flat road that it counts on cannot be believed for longer.
    fine_s: how much of it is planned period by period; after that an interval is two periods.
    rho: (m/s²)², weight of the relative tyre load, as in the objective J.
    input_weight: of (c − 1)², c in kN·s/m; keeps the plan definite where nothing moves.
    force: on a car with actuators, how they are used.
    road: how preview and measurement become one road.
    """

    horizon_s: float = 0.3
    blind_horizon_s: float = 0.2
    fine_s: float = 0.2
    rho: float = 3.0
    input_weight: float = 1e-3
    force: ForceSettings = field(default_factory=ForceSettings)
    road: RoadSettings = field(default_factory=RoadSettings)

    def __post_init__(self) -> None:
        _within("horizon_s", self.horizon_s, 0.02, 1.0)
        _within("blind_horizon_s", self.blind_horizon_s, 0.02, 1.0)
        _within("fine_s", self.fine_s, 0.0, 1.0)
        _within("rho", self.rho, 0.0, 1e3)
        _within("input_weight", self.input_weight, 1e-9, 1e9)


@dataclass(frozen=True)
class SupervisorSettings:
    """When a controller's answer is not used, and what is used instead.

    reactive: the law that takes over. stale_s: age from which a preview is no longer believed. highest_m:
    largest height that a preview may claim. transfer_s: time in which the step between two controllers fades.
    """

    reactive: Literal["skyhook", "skyhook2", "groundhook", "hybrid", "add", "sh_add", "pdd"] = "skyhook"
    stale_s: float = 0.5
    highest_m: float = 0.4
    transfer_s: float = 0.005

    def __post_init__(self) -> None:
        _within("stale_s", self.stale_s, 0.0, 1e3)
        _within("highest_m", self.highest_m, 0.0, 10.0)
        _within("transfer_s", self.transfer_s, 0.0, 1.0)


@dataclass(frozen=True)
class ControllerSettings:
    """Settings of all controllers, of which each takes its own.

    user: keyword arguments of a controller of the user's own.
    """

    passive: PassiveSettings = field(default_factory=PassiveSettings)
    fixed: FixedSettings = field(default_factory=FixedSettings)
    skyhook: SkyhookSettings = field(default_factory=SkyhookSettings)
    skyhook2: TwoStateSettings = field(default_factory=TwoStateSettings)
    groundhook: TwoStateSettings = field(default_factory=TwoStateSettings)
    hybrid: HybridSettings = field(default_factory=HybridSettings)
    add: TwoStateSettings = field(default_factory=TwoStateSettings)
    sh_add: ShAddSettings = field(default_factory=ShAddSettings)
    pdd: TwoStateSettings = field(default_factory=TwoStateSettings)
    lqr_clipped: LqrSettings = field(default_factory=LqrSettings)
    mpc: MpcSettings = field(default_factory=MpcSettings)
    supervisor: SupervisorSettings = field(default_factory=SupervisorSettings)
    user: dict[str, float] = field(default_factory=dict)


def _hard_and_soft(hard_ns_m: float, soft_ns_m: float) -> None:
    _within("hard_ns_m", hard_ns_m, 0.0, inf)
    _within("soft_ns_m", soft_ns_m, 0.0, hard_ns_m)


def _within(name: str, value: float, low: float, high: float) -> None:
    if not (isfinite(value) and low <= value <= high):
        allowed = f"lie in {low:g} ... {high:g}" if isfinite(high) else f"be finite and >= {low:g}"
        raise InputError(f"{name} must {allowed}, got {value:g}")
