"""Consistency of the observer: true errors against claimed covariances on random roads.

`foreride table observer --first 0 --events 20 --seeds 0,1`. NEES is the squared error of a group of states
under its claimed covariance, per state, averaged over all drives; NIS that of a sensor's innovation. Both are
one if the claims are true. The 95 % band of the NEES is the chi-square band of its mean over independent
drives at one instant; errors change slowly, so a mean over time has little more to go by. `within` counts the
instants at which the NEES lies in its own 95 % band, and the drives whose NIS lies in theirs (Bar-Shalom, Li
& Kirubarajan, Estimation with applications to tracking and navigation, 2001, ch. 5.4).
"""

from collections.abc import Sequence

import numpy as np
from scipy.stats import chi2

from foreride.controller.registry import CONTROLLERS
from foreride.scenarios.cases import Case
from foreride.scenarios.commands.console import tracked
from foreride.scenarios.definition.overrides import parse_override
from foreride.scenarios.random_roads.events import event_scenario
from foreride.scenarios.simulation.observer_claims import Claims, observer_claims, state_groups
from foreride.scenarios.tables.options import parse_words, table_parser, whole_numbers
from foreride.scenarios.tables.random_roads import events_of

_TAIL, _STREAMS = 0.025, 100_000
"""Tail of the bands; distance of two seeds, as each event has sensors of its own."""


def main(arguments: Sequence[str] | None = None) -> None:
    """Simulate and print the tables. Raises InputError."""
    parser = table_parser("observer", "errors of the observer against its claims, on random roads")
    parser.add_argument("--first", type=int, default=0, help="number of the first event (default 0)")
    parser.add_argument("--events", type=int, default=20, help="how many (default 20)")
    parser.add_argument("--seeds", default="0", help="of the sensors (default 0)")
    parser.add_argument("--controller", default="skyhook", help="that moves the dampers (default skyhook)")
    parser.add_argument("--set", action="append", default=[], dest="overrides", metavar="PATH.TO.FIELD=VALUE")
    parser.set_defaults(jobs=1)
    asked = parser.parse_args(arguments)
    parse_words("--controller", asked.controller, CONTROLLERS.names())
    events, seeds = events_of(asked), whole_numbers("--seeds", asked.seeds)
    overrides = [parse_override(text) for text in asked.overrides]
    cases = [
        Case(event_scenario(event, overrides), asked.controller, "none", _STREAMS * seed + event)
        for event in events
        for seed in seeds
    ]
    drives = list(tracked(map(observer_claims, cases), "drives", len(cases)))
    print("\n".join([*error_table(drives), "", *innovation_table(drives)]))


def error_table(drives: Sequence[Claims]) -> list[str]:
    """NEES, RMS error and claimed standard deviation of each group of states."""
    table = ["| state | NEES | 95 % band | within | RMS error | claimed | mean error |", "|---" * 7 + "|"]
    for name in state_groups(drives[0].car):
        nees, errors, variances, size = [], [], [], 0
        for drive in drives:
            group = state_groups(drive.car)[name]
            error, covariance = drive.errors @ group.T, group @ drive.covariances @ group.T
            nees.append(normalised(error, covariance))
            errors.append(error)
            variances.append(np.trace(covariance, axis1=1, axis2=2) / len(group))
            size = len(group)
        every, error = np.concatenate(nees), np.concatenate(errors)
        low, high = chi2.ppf([_TAIL, 1.0 - _TAIL], size) / size
        inside = np.mean((every >= low) & (every <= high))
        rms, claimed = np.sqrt(np.mean(error**2)), np.sqrt(np.mean(np.concatenate(variances)))
        cells = [f"{every.mean():.2f}", _band(size * len(drives)), f"{inside:.0%}"]
        cells += [f"{rms:.2g}", f"{claimed:.2g}", f"{error.mean():+.1g}"]
        table.append(f"| {name} | {' | '.join(cells)} |")
    return table


def innovation_table(drives: Sequence[Claims]) -> list[str]:
    """NIS and correlation of successive innovations of each sensor, over wheels."""
    heads = "sensor | NIS | drives within 95 % | correlation of successive innovations"
    table = [f"| {heads} |", "|---" * 4 + "|"]
    wheels = drives[0].car.wheels
    for name, rows in (("suspension travel", slice(0, wheels)), ("gyros", slice(wheels, None))):
        nis, inside, correlation = [], [], []
        for drive in drives:
            innovation = drive.innovations[:, rows]
            squares = np.mean(innovation**2, axis=0)
            low, high = chi2.ppf([_TAIL, 1.0 - _TAIL], len(innovation)) / len(innovation)
            nis.append(squares)
            inside.append((squares >= low) & (squares <= high))
            correlation.append(np.mean(innovation[1:] * innovation[:-1], axis=0) / squares)
        cells = [f"{np.mean(nis):.2f}", f"{np.mean(inside):.0%}", f"{np.mean(correlation):+.3f}"]
        table.append(f"| {name} | {' | '.join(cells)} |")
    return table


def normalised(error: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    """Squared error (n,) of errors (n, k) under covariances (n, k, k), per state."""
    solved = np.linalg.solve(covariance, error[:, :, None])[:, :, 0]
    return np.asarray(np.sum(error * solved, axis=1) / error.shape[1])


def _band(freedom: int) -> str:
    """Band of 95 % of a mean of squared standard normal numbers."""
    low, high = chi2.ppf([_TAIL, 1.0 - _TAIL], freedom) / freedom
    return f"{low:.2f} - {high:.2f}"
