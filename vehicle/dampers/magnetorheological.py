"""Magnetorheological damper models; see `vehicle.dampers.model` for the common interface."""

from dataclasses import dataclass, replace
from math import atanh, sqrt, tanh
from typing import Annotated, Any, ClassVar

from annotated_types import Interval

from foreride.files.errors import InputError
from foreride.vehicle.dampers.model import DamperModel
from foreride.vehicle.quantities import SignedForce, Viscous

Bend = Annotated[float, Interval(ge=-100.0, le=100.0), "1"]
Creep = Annotated[float, Interval(ge=1.0, le=1e6), "N·s/m"]
Evolution = Annotated[float, Interval(ge=1.0, le=1e8), "N/m"]


@dataclass(frozen=True)
class MrTanhDamper(DamperModel):
    """Magnetorheological damper: hyperbolic-tangent model with hysteresis.

    force = c·v + alpha·tanh(beta·v + delta·sgn(x)) with c, alpha and delta of the current (N. M. Kwok et al.,
    A novel hysteretic model for magnetorheological fluid dampers and parameter identification using particle
    swarm optimization, Sensors and Actuators A 132, 2006, fit for a LORD RD-1005). The paper's linear
    stiffness and constant gas force are omitted: they belong to the car's spring. The sign is smoothed over
    `switch_m`. The model returns energy where beta·|v| < delta; a run's energy audit quantifies it.
    """

    kind: ClassVar[str] = "mr_tanh"
    substeps: ClassVar[int] = 2

    current_max_a: Annotated[float, Interval(ge=0.01, le=100.0), "A"] = 2.0
    viscous_ns_m: tuple[Viscous, Viscous] = (1232.0, 1929.0)  # constant, per A
    yield_n: tuple[SignedForce, SignedForce, SignedForce] = (32.0, 918.0, -244.0)  # constant, per A, per A²
    slope_s_m: Annotated[float, Interval(ge=1e-6, le=1e5), "s/m"] = 100.0
    hysteresis: tuple[Bend, Bend] = (0.58, 0.30)  # constant, per A
    switch_m: Annotated[float, Interval(ge=1e-6, le=0.1), "m"] = 0.001

    def __post_init__(self) -> None:
        super().__post_init__()
        if not all(0.0 < self._strength(0.125 * k * self.current_max_a) <= 1e5 for k in range(9)):
            raise InputError(
                "yield_n must give > 0 and <= 100000 N at each current of 0 ... current_max_a, "
                f"got {list(self.yield_n)}"
            )

    def force(
        self, setting: Any, normalised_setting: Any, travel: Any, rate: Any, internal_states: list, xp: Any
    ) -> Any:
        """Force on the body, up, N."""
        amps = self.current_max_a * normalised_setting
        viscous = self.viscous_ns_m[0] + self.viscous_ns_m[1] * amps
        strength = self._strength(amps)
        bent = (self.hysteresis[0] + self.hysteresis[1] * amps) * xp.tanh(travel / self.switch_m)
        return -viscous * rate - strength * xp.tanh(self.slope_s_m * rate + bent)

    def reduced(self, steepest_ns_m: float) -> "MrTanhDamper":
        """Return the damper with a less steep transition through zero and without hysteresis."""
        amps = self.current_max_a
        strongest = self._strength(amps)
        left = steepest_ns_m - self.viscous_ns_m[0] - self.viscous_ns_m[1] * amps
        slope = min(self.slope_s_m, max(left, 0.1 * steepest_ns_m) / strongest)
        return replace(self, slope_s_m=slope, hysteresis=(0.0, 0.0))

    def _strength(self, amps: Any) -> Any:
        """Force of the yielded fluid, N."""
        return self.yield_n[0] + self.yield_n[1] * amps + self.yield_n[2] * amps**2


@dataclass(frozen=True)
class MrBoucWenDamper(DamperModel):
    """Magnetorheological damper: modified Bouc-Wen model; internal states y and z, m.

    B. F. Spencer et al., Phenomenological model for magnetorheological dampers, J. Eng. Mech. 123(3), 1997,
    with exponent 2 and without the accumulator's spring k₁. Values of C. Y. Lai and W. H. Liao, Vibration
    control of a suspension system via a magnetorheological fluid damper, J. Vib. Control 8, 2002.
    Pairs are (constant, per V).
    """

    kind: ClassVar[str] = "mr_bouc_wen"
    internal_states: ClassVar[int] = 2
    substeps: ClassVar[int] = 4

    voltage_max_v: Annotated[float, Interval(ge=0.01, le=100.0), "V"] = 2.0
    c0_ns_m: tuple[Viscous, Viscous] = (784.0, 1803.0)
    c1_ns_m: tuple[Creep, Viscous] = (14649.0, 34622.0)
    k0_n_m: Annotated[float, Interval(ge=0.0, le=1e6), "N/m"] = 3610.0
    alpha_n_m: tuple[Evolution, Evolution] = (12441.0, 38430.0)
    gamma_m2: Annotated[float, Interval(ge=1.0, le=1e8), "1/m²"] = 136320.0
    beta_m2: Annotated[float, Interval(ge=1.0, le=1e8), "1/m²"] = 2059020.0
    gain: Annotated[float, Interval(ge=0.1, le=1e4), "1"] = 58.0  # A of the paper

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.gamma_m2 >= self.beta_m2:
            raise InputError(f"gamma_m2 must be < beta_m2 ({self.beta_m2:g}), got {self.gamma_m2:g}")

    def _node_velocity(
        self, normalised_setting: Any, travel: Any, rate: Any, internal_states: list
    ) -> tuple[Any, Any]:
        """Velocity of the internal node y, and c₁."""
        y, z = internal_states
        volts = self.voltage_max_v * normalised_setting
        c0, c1, alpha = (pair[0] + pair[1] * volts for pair in (self.c0_ns_m, self.c1_ns_m, self.alpha_n_m))
        return (alpha * z + c0 * rate + self.k0_n_m * (travel - y)) / (c0 + c1), c1

    def force(
        self, setting: Any, normalised_setting: Any, travel: Any, rate: Any, internal_states: list, xp: Any
    ) -> Any:
        """Force on the body, up, N."""
        velocity, c1 = self._node_velocity(normalised_setting, travel, rate, internal_states)
        return -c1 * velocity

    def internal_state_rates(
        self, normalised_setting: Any, travel: Any, rate: Any, internal_states: list, xp: Any
    ) -> list:
        """Time derivatives of y and z."""
        velocity, _ = self._node_velocity(normalised_setting, travel, rate, internal_states)
        slip, z = rate - velocity, internal_states[1]
        evolved = self.gain * slip - self.gamma_m2 * xp.fabs(slip) * z * xp.fabs(z)
        return [velocity, evolved - self.beta_m2 * slip * z**2]

    def reduced(self, steepest_ns_m: float) -> "MrTanhDamper":
        """Return the static force curve at yield: z at its bound, the internal node at rest."""
        bound = sqrt(self.gain / (self.beta_m2 + self.gamma_m2))
        curve = MrTanhDamper(
            current_max_a=self.voltage_max_v,
            viscous_ns_m=self.c0_ns_m,
            yield_n=(self.alpha_n_m[0] * bound, self.alpha_n_m[1] * bound, 0.0),
        )
        return curve.reduced(steepest_ns_m)

    def advance(
        self, normalised_setting: float, travel: float, rate: float, internal_states: list, step_s: float
    ) -> list:
        """Internal states after a step at constant slip rate, for which z has a closed-form solution.

        With s = |slip|·t and w = z·sign(slip) its equation reads dw/ds = A - (beta ± gamma)·w², + for w > 0:
        a hyperbolic tangent. As z may reverse within 0.1 mm of slip, explicit steps would be unstable.
        """
        velocity, _ = self._node_velocity(normalised_setting, travel, rate, internal_states)
        slip, z = rate - velocity, internal_states[1]
        path, sign = abs(slip) * step_s, (1.0 if slip >= 0.0 else -1.0)
        w = z * sign
        if w < 0.0:
            bound = sqrt(self.gain / (self.beta_m2 - self.gamma_m2))
            needed = bound / self.gain * atanh(min(-w / bound, 1.0 - 1e-12))
            if path <= needed:
                return [
                    internal_states[0] + velocity * step_s,
                    sign * bound * tanh(self.gain / bound * (path - needed)),
                ]
            path, w = path - needed, 0.0
        bound = sqrt(self.gain / (self.beta_m2 + self.gamma_m2))
        start = atanh(min(w / bound, 1.0 - 1e-12))
        return [internal_states[0] + velocity * step_s, sign * bound * tanh(start + self.gain / bound * path)]

    def midway(
        self, normalised_setting: float, travel: float, rate: float, internal_states: list, step_s: float
    ) -> list:
        """Internal states in the middle of the step, at the same travel."""
        return self.advance(normalised_setting, travel, rate, internal_states, 0.5 * step_s)
