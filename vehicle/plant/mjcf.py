"""MJCF model of a car (MuJoCo's model format).

Joint position zero is static equilibrium on a flat road: gravity is balanced by the springs' rest lengths and
a bias force of the tyres. The suspension length is linear in the motions of body and wheel (small angles).
With equal inertia in pitch and yaw the two hinges of a full car do not couple, so its mass matrix is the
diagonal one of `vehicle.equations` at any angle.
"""

from foreride.vehicle.corner import GRAVITY_M_S2, Corner
from foreride.vehicle.dampers.damper import IdealDamper
from foreride.vehicle.load import Car

_CAR = """<mujoco model="{kind}">
  <option timestep="{step_s}" integrator="RK4" gravity="0 0 -{gravity}">
    <flag contact="disable" constraint="disable" sensor="disable" warmstart="disable" autoreset="disable"/>
  </option>
  <worldbody>
{bodies}
  </worldbody>
  <tendon>
{tendons}
  </tendon>
  <actuator>
{actuators}
  </actuator>
</mujoco>
"""
_BODY_JOINTS = (
    '<joint name="heave" type="slide" axis="0 0 1"/>',
    '<joint name="pitch" type="hinge" axis="0 1 0"/>',
    '<joint name="roll" type="hinge" axis="1 0 0"/>',
)
_BODY = """    <body name="body">
      {joints}
      <inertial pos="0 0 0" mass="{mass}" diaginertia="{inertia}"/>
    </body>"""
_WHEEL = """    <body name="{name}" pos="{corner.x_m} {corner.y_m} 0">
      <joint name="{name}" type="slide" axis="0 0 1"/>
      <inertial pos="0 0 0" mass="{corner.unsprung_mass_kg}" diaginertia="1 1 1"/>
    </body>"""
# Control: requested damping. Activation: actual damping, behind the lag. Force: minus damping times rate.
_DAMPER = """    <general name="{name}_damper" tendon="{name}_strut"
             dyntype="filter" dynprm="{corner.damper_lag_s}" gaintype="affine" gainprm="0 0 -1"
             ctrllimited="true" ctrlrange="{corner.damping_min_ns_m} {corner.damping_max_ns_m}"/>"""
# Linearised damper: the control of the first is its slope, that of the second its force at zero rate.
_SLOPE = '    <general name="{name}_damper" tendon="{name}_strut" gaintype="affine" gainprm="0 0 -1"/>'
_OFFSET = '    <general name="{name}_damper_offset" tendon="{name}_strut"/>'
# Control: requested force. Activation: actual force, behind the lag.
_ACTUATOR = """    <general name="{name}_actuator" tendon="{name}_strut" ctrllimited="true"
             ctrlrange="-{corner.actuator.force_limit_n} {corner.actuator.force_limit_n}"
             dyntype="filter" dynprm="{corner.actuator.lag_s}"/>"""
# Control: pitching moment of the longitudinal inertial force.
_SURGE = '    <general name="surge" joint="pitch"/>'
# Control: force due to the road's motion. A tyre cannot pull, hence the force range.
_TYRE = """    <general name="{name}_tyre" joint="{name}" biastype="affine"
             biasprm="{corner.static_tyre_n} -{corner.tyre_n_m} -{corner.tyre_damping_ns_m}"
             forcelimited="true" forcerange="0 1e12"/>"""
_WHEEL_NAMES = {
    1: ("wheel",),
    2: ("front", "rear"),
    4: ("front_left", "front_right", "rear_left", "rear_right"),
}


def car_xml(parameters: Car, step_s: float) -> str:
    """Return the MJCF of a car.

    Joints: the body's motions, then the wheels. Actuators: dampers, tyres, actuators, offsets of dampers that
    are no MuJoCo elements, and the surge moment of a car that pitches; absent elements are omitted.
    """
    first_corner = parameters.corners[0]
    native = isinstance(first_corner.damper, IdealDamper)
    parts = [_DAMPER if native else _SLOPE, _TYRE]
    parts += [_ACTUATOR] if first_corner.actuator else []
    parts += [] if native else [_OFFSET]
    wheels = list(zip(_WHEEL_NAMES[parameters.wheels], parameters.corners, strict=True))
    tendons = [_strut(name, corner) for name, corner in wheels]
    tendons += [stop for name, corner in wheels for stop in _stops(name, corner)]
    tendons += [_progression(name, corner) for name, corner in wheels if corner.spring_n_m3]
    tendons += [bend for name, corner in wheels for bend in _bends(name, corner)]
    tendons += _anti_roll_bars(parameters)
    return _CAR.format(
        kind=parameters.kind,
        step_s=step_s,
        gravity=GRAVITY_M_S2,
        bodies="\n".join([_body(parameters), *(_WHEEL.format(name=n, corner=c) for n, c in wheels)]),
        tendons="\n".join(tendons),
        actuators="\n".join(
            [
                *(part.format(name=n, corner=c) for part in parts for n, c in wheels),
                *[_SURGE][: len(parameters.generalised_mass) - 1],
            ]
        ),
    )


def _body(parameters: Car) -> str:
    mass, *angular = parameters.generalised_mass
    pitch, roll = (*angular, *angular, 1.0, 1.0)[:2]
    joints = "\n      ".join(_BODY_JOINTS[: len(parameters.generalised_mass)])
    return _BODY.format(joints=joints, mass=mass, inertia=f"{roll} {pitch} {pitch}")


def _tendon(name: str, stiffness: str, springlength: str, length: dict[str, float]) -> str:
    """Spring on a tendon whose length is a linear combination of joint coordinates."""
    joints = [f'      <joint joint="{joint}" coef="{coef}"/>' for joint, coef in length.items()]
    head = f'    <fixed name="{name}" stiffness="{stiffness}" springlength="{springlength}">'
    return "\n".join([head, *joints, "    </fixed>"])


def _rattle(name: str, corner: Corner, sign: float = 1.0) -> dict[str, float]:
    """Suspension travel as a combination of joints: body minus wheel, positive when extended."""
    motions = zip(("heave", "pitch", "roll"), corner.kinematic_row, strict=False)
    return {joint: sign * arm for joint, arm in motions} | {name: -sign}


def _strut(name: str, corner: Corner) -> str:
    length = _rattle(name, corner)
    stiffness, _ = corner.spring_ramps
    return _tendon(f"{name}_strut", f"{stiffness}", f"{corner.static_rattle_m}", length)


def _stops(name: str, corner: Corner) -> list[str]:
    """Bump stops: purely quadratic stiffness beyond the gap."""
    law, jounce, rebound = f"0 {corner.stop_n_m2}", corner.stop_gap_m, corner.rebound_gap_m
    return [
        _tendon(f"{name}_rebound_stop", law, f"-1e3 {rebound}", _rattle(name, corner)),
        _tendon(f"{name}_jounce_stop", law, f"-1e3 {jounce}", _rattle(name, corner, -1.0)),
    ]


def _progression(name: str, corner: Corner) -> str:
    """Progressive (cubic) part of the spring."""
    return _tendon(f"{name}_progression", f"0 0 {corner.spring_n_m3}", "0", _rattle(name, corner))


def _bends(name: str, corner: Corner) -> list[str]:
    """Stiffness that a spring table adds beyond each of its bends."""
    length = _rattle(name, corner, -1.0)
    return [
        _tendon(f"{name}_bend_{i}", f"{added}", f"-1e3 {place}", length)
        for i, (place, added) in enumerate(corner.spring_ramps[1])
    ]


def _anti_roll_bars(parameters: Car) -> list[str]:
    """Anti-roll bars: springs on the difference in suspension travel of an axle's wheels."""
    bars, names = [], _WHEEL_NAMES[parameters.wheels]
    for axle, stiffness in enumerate(parameters.anti_roll_n_m):
        left, right = 2 * axle, 2 * axle + 1
        lengths = [_rattle(names[i], parameters.corners[i], sign) for i, sign in ((left, 1.0), (right, -1.0))]
        joints = {joint for length in lengths for joint in length}
        difference = {j: lengths[0].get(j, 0.0) + lengths[1].get(j, 0.0) for j in sorted(joints)}
        bars.append(_tendon(f"anti_roll_bar_{axle}", f"{stiffness}", "0", difference))
    return bars
