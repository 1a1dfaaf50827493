"""State layout: the rows of each quantity in the state vector of `vehicle.equations`, by name."""

from typing import NamedTuple

from foreride.vehicle.load import Car


class StateLayout(NamedTuple):
    """Slices of the state vector (states, ...).

    motion: positions and velocities of body and wheels together. damping: the dampers' settings. force: the
    actuators' forces. internal_states: those of the dampers.
    """

    body: slice
    body_velocity: slice
    wheel: slice
    wheel_velocity: slice
    motion: slice
    damping: slice
    force: slice
    internal_states: slice


def state_layout(parameters: Car) -> StateLayout:
    """Return the layout of a car's state vector."""
    corner, wheels = parameters.corners[0], parameters.wheels
    wheel = 2 * len(parameters.generalised_mass)
    damping = wheel + 2 * wheels
    force = damping + wheels
    internal_states = force + (wheels if corner.actuator else 0)
    end = internal_states + corner.damper.internal_states * wheels
    return StateLayout(
        body=slice(0, wheel, 2),
        body_velocity=slice(1, wheel, 2),
        wheel=slice(wheel, damping, 2),
        wheel_velocity=slice(wheel + 1, damping, 2),
        motion=slice(0, damping),
        damping=slice(damping, force),
        force=slice(force, internal_states),
        internal_states=slice(internal_states, end),
    )
