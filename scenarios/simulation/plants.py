"""Plant of a scenario: MuJoCo's model of its car, or the FMU that the scenario names."""

from foreride.scenarios.definition.schema import Scenario
from foreride.vehicle.plant.plant import Plant


def build_plant(scenario: Scenario) -> Plant:
    """Build the plant of a scenario. Raises InputError for an FMU that does not fit the car."""
    vehicle = scenario.vehicle
    if vehicle.fmu is None:
        return Plant(scenario.true_car, scenario.engine)
    from foreride.vehicle.plant.fmu_plant import FmuPlant  # FMUs are an extra

    return FmuPlant(vehicle.parameters, vehicle.fmu, vehicle.map)
