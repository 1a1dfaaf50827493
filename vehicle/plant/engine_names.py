"""Names of the engines that integrate a car, and the cars that each can."""

from typing import Literal

from foreride.files.errors import InputError
from foreride.vehicle.dampers.damper import IdealDamper
from foreride.vehicle.load import Car

EngineName = Literal["mujoco", "compiled"]


def require_compilable(parameters: Car) -> None:
    """Raise InputError for a car that the compiled engine cannot integrate."""
    damper = parameters.corners[0].damper
    if not isinstance(damper, IdealDamper):
        raise InputError(f"engine compiled needs ideal dampers, got {damper.kind}; leave mujoco")
