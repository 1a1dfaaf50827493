"""Notes on the cars of a comparison: damping ratios of passive dampers, and whose tuning the laws have."""

from collections.abc import Sequence

from foreride.controller.command_limits import front_wheels
from foreride.controller.gain_scaling import critical_damping
from foreride.controller.tuned_settings import borrowed_tuning
from foreride.files.writing.sharing import shared_name
from foreride.scenarios.cases import Case
from foreride.scenarios.definition.schema import Scenario
from foreride.vehicle.load import Car


def car_notes(cases: Sequence[Case]) -> tuple[str, ...]:
    """Notes on the scenarios and controllers of the cases, each once."""
    ratios = [note for case in cases if (note := damping_ratios(case))]
    return tuple(dict.fromkeys([*ratios, *tuning_notes(cases)]))


def damping_ratios(case: Case) -> str | None:
    """Ratio of a constant damping to the critical one of the body on its springs, by axle."""
    scenario = case.scenario
    settings, car = scenario.control.settings, scenario.vehicle.parameters
    if case.controller == "passive":
        passive = settings.passive.damping_ns_m
        built = [corner.damping_passive_ns_m for corner in car.corners]
        damping = built if passive is None else [passive] * car.wheels
    elif case.controller in ("fixed", "fixed_best"):
        axles = getattr(settings, case.controller)
        damping = [axles.front_ns_m if front else axles.rear_ns_m for front in front_wheels(car)]
    else:
        return None
    return f"{case.controller} on {_name(scenario)}: damping ratio {_by_axle(car, damping)}"


def tuning_notes(cases: Sequence[Case]) -> list[str]:
    """Laws whose tuning is another car's, a line for each car, with the command that tunes them for it."""
    laws: dict[tuple[str, str], list[str]] = {}
    for case in cases:
        scenario, law = case.scenario, case.controller
        tuned_for = borrowed_tuning(scenario.vehicle.parameters, scenario.control.settings, law)
        if tuned_for is not None:
            laws.setdefault((_name(scenario), tuned_for), []).append(law)
    return [_tuning_note(*key, ",".join(dict.fromkeys(names))) for key, names in laws.items()]


def _tuning_note(name: str, tuned_for: str, laws: str) -> str:
    file = name if name.endswith((".yaml", ".yml")) else "FILE.yaml"
    return (
        f"{laws} on {name}: as tuned for {tuned_for}, scaled with mass and stiffness; for this car: "
        f"foreride tune --vehicle {file} --controllers {laws} --out mine.yaml, then --settings mine.yaml"
    )


def _name(scenario: Scenario) -> str:
    return shared_name(scenario.vehicle.model)


def _by_axle(car: Car, damping: Sequence[float]) -> str:
    """Damping ratios of the axles; wheels of an axle are alike."""
    ratios = [value / critical_damping(corner) for value, corner in zip(damping, car.corners, strict=True)]
    return f"{ratios[0]:.2f}" if car.wheels == 1 else f"{ratios[0]:.2f} front, {ratios[-1]:.2f} rear"
