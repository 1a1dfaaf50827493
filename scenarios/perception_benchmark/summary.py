"""Statistics of the perception benchmark: errors by distance, timing, consistency, shape, range, misses."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.stats import chi2

from foreride.scenarios.perception_benchmark.judge import Encounter, TrackEstimate, encounters, false_tracks
from foreride.scenarios.simulation.simulate import Run

BINS_M = (2.5, 4.0, 6.0, 8.0, 10.0, 15.0, 20.0, 30.0)
_IN_ORDER = ("bias_m", "sigma_m", "timing_ms_95")


def summarise(runs: Sequence[Run]) -> dict[str, Any]:
    """One row of the perception report over all drives of `runs`.

    At the distance of use: `bias_m`, `sigma_m` of the near edge, `timing_ms_95` (95th percentile of |error| /
    speed), `nees` (normalised estimation error squared: mean squared error over stated variance) with its 95
    % acceptance band for a consistent estimator. `height_error_rms` is relative. `by_distance` holds bias and
    sigma for bins of distance, `by_order` those and the timing for the first, second, ... obstacle of a
    drive, from which the estimator learns. None stands for undefined values.
    """
    drives = [encounters(run) for run in runs]
    met = [encounter for drive in drives for encounter in drive]
    used = _used(met)
    false = sum(false_tracks(run) for run in runs)
    km = sum(float(run.signals["x_m"][-1] - run.signals["x_m"][0]) for run in runs) / 1000
    confirmed_m = [
        encounter.first_confirmed_m for encounter in met if encounter.first_confirmed_m is not None
    ]
    return {
        "events": len(met),
        "missed": len(met) - len(used),
        "false_tracks": false,
        "false_per_km": false / km if km > 0 else None,
        "distance_km": km,
        "first_confirmed_median_m": float(np.median(confirmed_m)) if confirmed_m else None,
        "first_confirmed_10_m": float(np.percentile(confirmed_m, 10)) if confirmed_m else None,
        **_at_use(used),
        **_shape(used),
        "by_distance": _by_distance(met),
        "by_order": _by_order(drives),
        "estimator_median_ms": _estimator_ms(runs),
    }


def _used(met: Sequence[Encounter]) -> list[tuple[Encounter, TrackEstimate]]:
    return [
        (encounter, track_estimate) for encounter in met if (track_estimate := encounter.used) is not None
    ]


def _at_use(used: Sequence[tuple[Encounter, TrackEstimate]]) -> dict[str, Any]:
    if len(used) < 2:
        return dict.fromkeys(("bias_m", "sigma_m", "timing_ms_95", "nees", "nees_band"))
    error = np.array([track_estimate.error_m for _, track_estimate in used])
    claimed = np.array([track_estimate.sigma_m for _, track_estimate in used])
    timing = np.abs(error) / [encounter.speed_m_s for encounter, _ in used]
    band = chi2.ppf([0.025, 0.975], len(used)) / len(used)
    return {
        "bias_m": float(error.mean()),
        "sigma_m": float(error.std(ddof=1)),
        "timing_ms_95": 1e3 * float(np.percentile(timing, 95)),
        "nees": float(np.mean((error / claimed) ** 2)),
        "nees_band": band.tolist(),
    }


def _shape(used: Sequence[tuple[Encounter, TrackEstimate]]) -> dict[str, Any]:
    if not used:
        return {"height_error_rms": None, "right_kind": None}
    relative = [track_estimate.height_m / encounter.true_height_m - 1 for encounter, track_estimate in used]
    right = [track_estimate.kind == encounter.true_kind for encounter, track_estimate in used]
    return {
        "height_error_rms": float(np.sqrt(np.mean(np.square(relative)))),
        "right_kind": float(np.mean(right)),
    }


def _by_distance(met: Sequence[Encounter]) -> list[dict[str, Any]]:
    track_estimates = [
        track_estimate
        for encounter in met
        for track_estimate in encounter.track_estimates
        if track_estimate.confirmed
    ]
    rows = []
    for near, far in pairwise(BINS_M):
        error = np.array(
            [
                track_estimate.error_m
                for track_estimate in track_estimates
                if near <= track_estimate.distance_m < far
            ]
        )
        if len(error) > 1:
            bias, sigma = float(error.mean()), float(error.std(ddof=1))
            rows.append({"from_m": near, "to_m": far, "bias_m": bias, "sigma_m": sigma, "count": len(error)})
    return rows


def _by_order(drives: Sequence[Sequence[Encounter]]) -> list[dict[str, Any]]:
    rows = []
    for order in range(max(map(len, drives), default=0)):
        used = _used([drive[order] for drive in drives if len(drive) > order])
        if len(used) > 1:
            told = _at_use(used)
            rows.append({"order": order + 1, "count": len(used)} | {key: told[key] for key in _IN_ORDER})
    return rows


def _estimator_ms(runs: Sequence[Run]) -> float | None:
    values = [run.timing["estimator_median_ms"] for run in runs if "estimator_median_ms" in run.timing]
    return float(np.median(values)) if values else None
