"""What can be set about each controller; a scenario's `control.settings` is a `ControllerSettings`."""

from dataclasses import dataclass, field
from typing import Annotated, Literal

from annotated_types import Interval

from files.errors import InputError
from files.ranges import Checked, Share
from vehicle.quantities import Damping

Horizon = Annotated[float, Interval(ge=0.02, le=1.0), "s"]
LoadWeight = Annotated[float, Interval(ge=0.0, le=1e3), "(m/s²)²"]
Smoothing = Annotated[float, Interval(ge=1e-4, le=1.0), "m/s"]


@dataclass(frozen=True)
class PassiveSettings(Checked):
    """damping_ns_m: one coefficient for every wheel; None takes the vehicle's own passive coefficients."""

    damping_ns_m: Damping | None = None


@dataclass(frozen=True)
class FixedSettings(Checked):
    """Constant damping by axle; wheels at or ahead of the centre of gravity are front wheels."""

    front_ns_m: Damping = 1500.0
    rear_ns_m: Damping = 1500.0


@dataclass(frozen=True)
class TwoStateSettings(Checked):
    """Damping of the laws that know hard and soft, as far as the dampers can do it."""

    hard_ns_m: Damping = 4500.0
    soft_ns_m: Damping = 300.0

    def __post_init__(self) -> None:
        super().__post_init__()
        _hard_and_soft(self.hard_ns_m, self.soft_ns_m)


@dataclass(frozen=True)
class ShAddSettings(Checked):
    """Mixed skyhook and acceleration-driven damping: skyhook below `crossover_hz`."""

    hard_ns_m: Damping = 4500.0
    soft_ns_m: Damping = 300.0
    crossover_hz: Annotated[float, Interval(ge=0.0, le=100.0), "Hz"] = 1.8

    def __post_init__(self) -> None:
        super().__post_init__()
        _hard_and_soft(self.hard_ns_m, self.soft_ns_m)


@dataclass(frozen=True)
class HybridSettings(Checked):
    """alpha: share of skyhook, the rest is groundhook. gain_ns_m: of both. The rest as skyhook's."""

    gain_ns_m: Damping = 3000.0
    alpha: Share = 0.5
    floor_ns_m: Damping = 300.0
    smoothing_m_s: Smoothing = 0.1


@dataclass(frozen=True)
class LqrSettings(Checked):
    """The clipped linear-quadratic regulator.

    nominal_ns_m: damping around which the car is linear. rho: (m/s²)², weight of the relative tyre load.
    force_weight: of (force in kN)². smoothing_m_s: as skyhook's.
    """

    nominal_ns_m: Annotated[float, Interval(ge=0.0, le=1e5), "N·s/m"] = 1000.0
    rho: LoadWeight = 3.0
    force_weight: Annotated[float, Interval(ge=1e-6, le=1e6), "(m/s²)²/kN²"] = 0.1
    smoothing_m_s: Smoothing = 0.1


@dataclass(frozen=True)
class SkyhookSettings(Checked):
    """The imagined dampers of the skyhook family.

    sky_ns_m: between body and sky. ground_ns_m: between wheel and ground.
    floor_ns_m: damping where the law asks for less.
    smoothing_m_s: suspension velocity under which the law fades to the floor, so noise cannot chatter it.
    """

    sky_ns_m: Damping = 4500.0
    ground_ns_m: Damping = 130.0
    floor_ns_m: Damping = 300.0
    smoothing_m_s: Smoothing = 0.1


@dataclass(frozen=True)
class RoadSettings(Checked):
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
    sigmas_early: Annotated[float, Interval(ge=0.0, le=3.0), "1"] = 1.0
    blend_m: Annotated[float, Interval(ge=1e-3, le=10.0), "m"] = 0.2
    slope_decay_s: Annotated[float, Interval(ge=1e-4, le=1.0), "s"] = 0.01


@dataclass(frozen=True)
class ForceSettings(Checked):
    """What a predictive controller may ask of actuators beside the dampers, within their greatest force.

    weight: of the square of a force in kN. rate_n_s: how fast a force may change; the default leaves that to
    the actuator's lag. power_w: most that a force may deliver at the rate at which its strut is expected to
    move.
    """

    weight: Annotated[float, Interval(ge=1e-9, le=1e6), "(m/s²)²/kN²"] = 1e-3
    rate_n_s: Annotated[float, Interval(ge=1.0, le=1e8), "N/s"] = 1e6
    power_w: Annotated[float, Interval(ge=1.0, le=1e7), "W"] = 5000.0


@dataclass(frozen=True)
class MpcSettings(Checked):
    """Horizon and cost of the model predictive controllers.

    horizon_s: length of the plan of a controller that sees ahead.
    blind_horizon_s: of one that does not; the flat road that it counts on cannot be believed for longer.
    fine_s: how much of it is planned period by period; after that an interval is two periods.
    rho: (m/s²)², weight of the relative tyre load, as in the objective J.
    input_weight: of (c − 1)², c in kN·s/m; keeps the plan definite where nothing moves.
    force: on a car with actuators, how they are used.
    road: how preview and measurement become one road.
    """

    horizon_s: Horizon = 0.3
    blind_horizon_s: Horizon = 0.2
    fine_s: Annotated[float, Interval(ge=0.0, le=1.0), "s"] = 0.2
    rho: LoadWeight = 3.0
    input_weight: Annotated[float, Interval(ge=1e-9, le=1e6), "(m/s²)²/(kN·s/m)²"] = 1e-3
    force: ForceSettings = field(default_factory=ForceSettings)
    road: RoadSettings = field(default_factory=RoadSettings)


@dataclass(frozen=True)
class SupervisorSettings(Checked):
    """When a controller's answer is not used, and what is used instead.

    reactive: the law that takes over. stale_s: age from which a preview is no longer believed. highest_m:
    largest height that a preview may claim. transfer_s: time in which the step between two controllers fades.
    """

    reactive: Literal["skyhook", "skyhook2", "groundhook", "hybrid", "add", "sh_add", "pdd"] = "skyhook"
    stale_s: Annotated[float, Interval(ge=0.0, le=1e3), "s"] = 0.5
    highest_m: Annotated[float, Interval(ge=0.0, le=10.0), "m"] = 0.4
    transfer_s: Annotated[float, Interval(ge=0.0, le=1.0), "s"] = 0.005


@dataclass(frozen=True)
class ControllerSettings(Checked):
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
    user: dict[str, Annotated[float, Interval(ge=-1e8, le=1e8), "1"]] = field(default_factory=dict)


def _hard_and_soft(hard_ns_m: float, soft_ns_m: float) -> None:
    if soft_ns_m > hard_ns_m:
        raise InputError(f"soft_ns_m must lie in 0 ... {hard_ns_m:g} N·s/m, hard_ns_m, got {soft_ns_m:g}")
