"""Controller settings; a scenario's `control.settings` is a `ControllerSettings`."""

from dataclasses import dataclass, field
from typing import Annotated, Literal

from annotated_types import Interval

from foreride.files.errors import InputError
from foreride.files.reading.ranges import Checked, Share
from foreride.vehicle.quantities import Damping

Horizon = Annotated[float, Interval(ge=0.02, le=1.0), "s"]
LoadWeight = Annotated[float, Interval(ge=0.0, le=1e3), "(m/s²)²"]
Smoothing = Annotated[float, Interval(ge=1e-4, le=1.0), "m/s"]


@dataclass(frozen=True)
class PassiveSettings(Checked):
    """Passive dampers of the car as built, or one coefficient for all wheels.

    damping_ns_m: damping coefficient of every wheel, N·s/m; None takes the vehicle's own passive
    coefficients.
    """

    damping_ns_m: Damping | None = None


@dataclass(frozen=True)
class FixedSettings(Checked):
    """Constant damping per axle, N·s/m; wheels at or ahead of the centre of gravity are front wheels."""

    front_ns_m: Damping = 1500.0
    rear_ns_m: Damping = 1500.0


@dataclass(frozen=True)
class TwoStateSettings(Checked):
    """Levels of the on–off laws, N·s/m, clipped to the dampers' range."""

    hard_ns_m: Damping = 4500.0
    soft_ns_m: Damping = 300.0

    def __post_init__(self) -> None:
        super().__post_init__()
        _hard_and_soft(self.hard_ns_m, self.soft_ns_m)


@dataclass(frozen=True)
class ShAddSettings(Checked):
    """Mixed skyhook and acceleration-driven damping: skyhook below `crossover_hz`, ADD above."""

    hard_ns_m: Damping = 4500.0
    soft_ns_m: Damping = 300.0
    crossover_hz: Annotated[float, Interval(ge=0.0, le=100.0), "Hz"] = 1.8

    def __post_init__(self) -> None:
        super().__post_init__()
        _hard_and_soft(self.hard_ns_m, self.soft_ns_m)


@dataclass(frozen=True)
class HybridSettings(Checked):
    """Hybrid skyhook–groundhook law.

    gain_ns_m: gain of both parts, N·s/m. alpha: weight of skyhook, the rest is groundhook. floor_ns_m,
    smoothing_m_s: as for skyhook.
    """

    gain_ns_m: Damping = 3000.0
    alpha: Share = 0.5
    floor_ns_m: Damping = 300.0
    smoothing_m_s: Smoothing = 0.1


@dataclass(frozen=True)
class LqrSettings(Checked):
    """Clipped linear-quadratic regulator.

    nominal_ns_m: damping about which the car is linearised, N·s/m. rho: weight of the relative tyre load,
    (m/s²)².
    force_weight: weight of (force in kN)². smoothing_m_s: as for skyhook.
    """

    nominal_ns_m: Annotated[float, Interval(ge=0.0, le=1e5), "N·s/m"] = 1000.0
    rho: LoadWeight = 3.0
    force_weight: Annotated[float, Interval(ge=1e-6, le=1e6), "(m/s²)²/kN²"] = 0.1
    smoothing_m_s: Smoothing = 0.1


@dataclass(frozen=True)
class SkyhookSettings(Checked):
    """Virtual dampers of the skyhook law.

    sky_ns_m: between body and sky, N·s/m. ground_ns_m: between wheel and ground, N·s/m.
    floor_ns_m: minimum damping, N·s/m.
    smoothing_m_s: suspension velocity below which the law fades to the floor, to avoid chatter by noise, m/s.
    """

    sky_ns_m: Damping = 4500.0
    ground_ns_m: Damping = 130.0
    floor_ns_m: Damping = 300.0
    smoothing_m_s: Smoothing = 0.1


@dataclass(frozen=True)
class RoadSettings(Checked):
    """Fusion of preview and measurement into the road reference of an MPC.

    uncertainty: treatment of uncertain position and existence of features. "early" expects them earlier and
    lower, "blend" only lower, the more the greater the uncertainty, "scenarios" plans for several roads at
    once, each with its probability.
    sigmas_early: number of standard deviations by which "early" advances features, as late preparation costs
    more than early one.
    known_m, unknown_m: position standard deviations up to which "early" uses a feature in full, and from
    which on it ignores the feature, as preparing for a wrong position costs more than not preparing, m.
    height_sigmas: number of standard deviations by which raised obstacles are planned lower than previewed,
    as expecting too much costs more than expecting too little.
    credibility: probability that a preview with stated uncertainties is right, before the wheels have
    confirmed its first feature.
    blend_m: standard deviation at which "blend" halves a feature's height, m.
    slope_decay_s: time constant with which a measured slope not explained by the preview decays, s.
    """

    uncertainty: Literal["early", "blend", "scenarios"] = "early"
    sigmas_early: Annotated[float, Interval(ge=0.0, le=3.0), "1"] = 1.0
    known_m: Annotated[float, Interval(ge=0.0, le=10.0), "m"] = 0.15
    unknown_m: Annotated[float, Interval(gt=0.0, le=20.0), "m"] = 0.3
    height_sigmas: Annotated[float, Interval(ge=0.0, le=3.0), "1"] = 0.35
    credibility: Share = 0.95
    blend_m: Annotated[float, Interval(ge=1e-3, le=10.0), "m"] = 0.2
    slope_decay_s: Annotated[float, Interval(ge=1e-4, le=1.0), "s"] = 0.01

    def __post_init__(self) -> None:
        super().__post_init__()
        _ordered("known_m", self.known_m, "unknown_m", self.unknown_m)


@dataclass(frozen=True)
class ForceSettings(Checked):
    """Use of actuators by the predictive controllers, within their force limits.

    weight: weight of the square of a force in kN. rate_n_s: limit of a force's rate of change, N/s; by
    default the actuator's lag is the only limit. power_w: limit of the power that a force delivers at the
    predicted suspension velocity, W.
    """

    weight: Annotated[float, Interval(ge=1e-9, le=1e6), "(m/s²)²/kN²"] = 1e-3
    rate_n_s: Annotated[float, Interval(ge=1.0, le=1e8), "N/s"] = 1e6
    power_w: Annotated[float, Interval(ge=1.0, le=1e7), "W"] = 5000.0


@dataclass(frozen=True)
class LimitSettings(Checked):
    """Soft limits of the predictive controllers, beside the weights of their cost; None for no limit.

    unloading: part of its static load that a tyre may lose.
    travel: part of the way to its stops that a suspension may use.
    penalty: cost of a violation by the whole load or way, in periods of the cost.
    """

    unloading: Annotated[float, Interval(ge=0.01, le=1.0), "1"] | None = None
    travel: Annotated[float, Interval(ge=0.01, le=1.0), "1"] | None = None
    penalty: Annotated[float, Interval(ge=0.01, le=1e6), "(m/s²)²"] = 50.0


@dataclass(frozen=True)
class MpcSettings(Checked):
    """Horizon and cost of the model predictive controllers.

    horizon_s: length of the plan with preview, s.
    blind_horizon_s: length of the plan without preview, s; its assumption of a flat road does not hold for
    longer.
    fine_s: initial part of the horizon with intervals of one period, s; from there to four times that they
    have two periods, then four.
    rho: weight of the relative tyre load, as in the objective J, (m/s²)².
    input_weight: weight of (c − 1)², c in kN·s/m; keeps the program definite at rest.
    move_weight: weight of the square of the change of c from one period to the next, c in kN·s/m.
    adapts: whether predictions are those of the car as identified in the drive (body mass, damper strength,
    delay of the commands) once it differs significantly from the car as known.
    force: use of the actuators, if the car has any.
    limits: soft limits of tyre load and travel.
    road: fusion of preview and measurement.
    """

    horizon_s: Horizon = 0.6
    blind_horizon_s: Horizon = 0.2
    fine_s: Annotated[float, Interval(ge=0.0, le=1.0), "s"] = 0.05
    rho: LoadWeight = 3.0
    input_weight: Annotated[float, Interval(ge=1e-9, le=1e6), "(m/s²)²/(kN·s/m)²"] = 1e-3
    move_weight: Annotated[float, Interval(ge=0.0, le=1e6), "(m/s²)²/(kN·s/m)²"] = 0.0
    adapts: bool = True
    force: ForceSettings = field(default_factory=ForceSettings)
    limits: LimitSettings = field(default_factory=LimitSettings)
    road: RoadSettings = field(default_factory=RoadSettings)


@dataclass(frozen=True)
class GateSettings(Checked):
    """Consistency gate of the preview: it is dropped while the front wheels feel another road.

    reach_m: tolerated position error; a claimed standard deviation is added (root sum of squares), m.
    widest_m: upper limit of that sum, m.
    height_m: tolerated height error; the road's roughness is added, m.
    gain: tolerated relative height error; two claimed standard deviations are added.
    least_gain: smallest share of a claimed height that must be felt in any case.
    strike_m: sum of residuals beyond these tolerances, over about 0.1 m of road, that is a contradiction, m.
    aside_m: distance for which a preview is suspended after an obstacle that it did not announce, m.
    correlation: least correlation between felt and claimed road.
    memory_m: distance constant of that correlation, m.
    half_life_s: time in which half of the lost trust is regained, s.
    lost, regained: hysteresis of the trust, which each contradiction halves: the preview is dropped below
    the first and used again from the second on.
    """

    reach_m: Annotated[float, Interval(ge=0.0, le=1.0), "m"] = 0.06
    widest_m: Annotated[float, Interval(ge=0.0, le=2.0), "m"] = 0.15
    height_m: Annotated[float, Interval(ge=0.0, le=1.0), "m"] = 0.008
    gain: Share = 0.2
    least_gain: Share = 0.3
    strike_m: Annotated[float, Interval(ge=1e-4, le=1.0), "m"] = 0.01
    aside_m: Annotated[float, Interval(ge=0.0, le=100.0), "m"] = 1.0
    correlation: Annotated[float, Interval(ge=-1.0, le=1.0), "1"] = 0.4
    memory_m: Annotated[float, Interval(ge=0.1, le=100.0), "m"] = 3.0
    half_life_s: Annotated[float, Interval(ge=0.1, le=1e3), "s"] = 10.0
    lost: Share = 0.6
    regained: Share = 0.8

    def __post_init__(self) -> None:
        super().__post_init__()
        _ordered("lost", self.lost, "regained", self.regained)


@dataclass(frozen=True)
class SupervisorSettings(Checked):
    """Conditions and fallback of the supervisor.

    reactive: fallback law. stale_s: age at which a preview becomes invalid, s. highest_m: largest valid
    relief of a preview, m: departure from a straight line, or rise within a metre. transfer_s: time constant
    with which the step between two controllers decays, s. gate: when a preview is dropped because the road
    contradicts it.
    """

    reactive: Literal["skyhook", "skyhook2", "groundhook", "hybrid", "add", "sh_add", "pdd"] = "skyhook"
    stale_s: Annotated[float, Interval(ge=0.0, le=1e3), "s"] = 0.5
    highest_m: Annotated[float, Interval(ge=0.0, le=10.0), "m"] = 0.4
    transfer_s: Annotated[float, Interval(ge=0.0, le=1.0), "s"] = 0.005
    gate: GateSettings = field(default_factory=GateSettings)


@dataclass(frozen=True)
class ControllerSettings(Checked):
    """Settings of all controllers, of which each takes its own.

    user: keyword arguments of a user-defined controller.
    """

    passive: PassiveSettings = field(default_factory=PassiveSettings)
    fixed: FixedSettings = field(default_factory=FixedSettings)
    fixed_best: FixedSettings = field(default_factory=FixedSettings)
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


def _ordered(lower: str, low: float, upper: str, high: float) -> None:
    if not low < high:
        raise InputError(f"{lower} must be < {high:g}, {upper}, got {low:g}")
