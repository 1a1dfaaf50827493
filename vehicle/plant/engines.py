"""Choice of the engine that integrates a car."""

from typing import TYPE_CHECKING

from foreride.vehicle.dampers.damper import IdealDamper
from foreride.vehicle.load import Car
from foreride.vehicle.plant.engine_names import EngineName, require_compilable
from foreride.vehicle.plant.mujoco_engine import RolloutEngine, SubsteppedEngine

if TYPE_CHECKING:  # Numba is slow to import
    from foreride.vehicle.plant.compiled_engine import CompiledEngine


def build_engine(
    parameters: Car, engine: EngineName = "mujoco"
) -> "RolloutEngine | SubsteppedEngine | CompiledEngine":
    """Build the engine of this name that suits the car's dampers."""
    if engine == "compiled":
        from foreride.vehicle.plant.compiled_engine import CompiledEngine

        require_compilable(parameters)
        return CompiledEngine(parameters)
    ideal = isinstance(parameters.corners[0].damper, IdealDamper)
    return RolloutEngine(parameters) if ideal else SubsteppedEngine(parameters)
