"""Claims of the observer over a short drive: errors that its covariances explain, white innovations."""

import numpy as np
import pytest

from foreride.files.errors import InputError
from foreride.scenarios.cases import Case
from foreride.scenarios.definition.overrides import parse_override
from foreride.scenarios.random_roads.events import event_scenario
from foreride.scenarios.simulation.observer_claims import observer_claims, state_groups


def test_errors_are_as_large_as_claimed_and_innovations_white() -> None:
    claims = observer_claims(Case(event_scenario(7), "skyhook", "none", 1))
    for name, group in state_groups(claims.car).items():
        error = claims.errors @ group.T
        claimed = np.sqrt(np.trace(group @ claims.covariances @ group.T, axis1=1, axis2=2) / len(group))
        assert np.sqrt(np.mean(error**2)) < 2.5 * np.sqrt(np.mean(claimed**2)), name
    innovations = claims.innovations
    np.testing.assert_allclose(np.mean(innovations**2, axis=0), 1.0, atol=0.2)
    assert np.abs(np.mean(innovations[1:] * innovations[:-1], axis=0)).max() < 0.1


@pytest.mark.parametrize(
    ("controller", "overrides", "field"),
    [("skyhook", ["observer=truth"], "observer"), ("passive", [], "passive")],
)
def test_a_drive_without_an_observer_is_refused(controller: str, overrides: list[str], field: str) -> None:
    scenario = event_scenario(7, [parse_override(text) for text in overrides])
    with pytest.raises(InputError, match=field):
        observer_claims(Case(scenario, controller, "none", 0))
