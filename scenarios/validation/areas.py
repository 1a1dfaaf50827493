"""Registry of the validation checks by area, and their execution."""

from collections.abc import Iterator

from foreride.scenarios.validation import comfort, published, ride, road, vehicle
from foreride.scenarios.validation.check import Check, Checks

AREAS: dict[str, Checks] = {
    "Road": road.CHECKS,
    "Vehicle": vehicle.CHECKS,
    "Published cases": published.CHECKS,
    "Comfort": comfort.CHECKS,
    "Ride": ride.CHECKS,
}


def count() -> int:
    """Number of checks."""
    return sum(len(checks) for checks in AREAS.values())


def run_all() -> Iterator[tuple[str, Check]]:
    """Yield area and result of each check; a check that raises fails with infinite deviation."""
    for area, checks in AREAS.items():
        for check in checks:
            try:
                yield area, check()
            except Exception as error:  # one broken check must not hide the others
                problem = f"{type(error).__name__}: {error}".splitlines()[0]
                yield area, Check(getattr(check, "__name__", str(check)), problem, float("inf"), 0.0)
