"""Tests of the notes on a comparison's cars."""

from foreride.scenarios.cases import Case
from foreride.scenarios.definition.loading import load
from foreride.scenarios.runs.car_notes import car_notes


def test_the_passive_references_have_their_damping_ratios() -> None:
    quarter = load("bump_8x40_30", ["vehicle.model=quarter"])
    half = load("bump_8x40_30")
    notes = car_notes([Case(quarter, "passive", "none", 0), Case(half, "fixed_best", "none", 0)] * 2)
    assert notes == (
        "passive on quarter: damping ratio 0.26",  # 1500 / (2·√(21000·400))
        "fixed_best on half: damping ratio 0.28 front, 0.20 rear",
    )


def test_laws_that_are_tuned_for_another_car_are_named_with_the_command() -> None:
    suv = load("bump_8x40_30", ["vehicle.model=suv"])
    notes = car_notes(
        [Case(suv, name, "none", 0) for name in ("skyhook", "hybrid", "fixed_best", "mpc_reactive")]
    )
    command = "foreride tune --vehicle FILE.yaml --controllers skyhook,hybrid --out mine.yaml"
    assert len(notes) == 2
    assert notes[1].startswith(
        "skyhook,hybrid on suv: as tuned for full_car, scaled with mass and stiffness;"
    )
    assert notes[1].endswith(f"for this car: {command}, then --settings mine.yaml")
    assert car_notes([Case(load("bump_8x40_30"), "skyhook", "none", 0)]) == ()
