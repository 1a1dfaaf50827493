"""Observation of a learnt controller: estimate and preview as one vector with named, dimensioned entries."""

from dataclasses import dataclass

import numpy as np

from foreride.controller.interface import Estimate
from foreride.preview.road_preview import RoadPreview
from foreride.vehicle.equations import state_size
from foreride.vehicle.load import Car, control_model

PREVIEW_TIMES_S = tuple(round(0.02 * step, 2) for step in range(1, 26))
"""Times ahead at which the previewed road is observed: 0.02 ... 0.5 s."""


@dataclass(frozen=True)
class ObservationLayout:
    """Layout of the observation of a car with this number of states and wheels.

    In order: the estimated state x (see `vehicle.equations`; m and m/s, rad and rad/s), road height (m) and
    its rate (m/s) under each wheel, speed (m/s), then for each wheel the previewed road height over the
    present one at `PREVIEW_TIMES_S`, m. Without a preview these are zero.
    """

    states: int
    wheels: int

    @classmethod
    def of(cls, car: Car) -> "ObservationLayout":
        """Layout for a car, as controllers know it."""
        return cls(state_size(control_model(car)), car.wheels)

    @property
    def names(self) -> tuple[str, ...]:
        """Name of each entry, with its unit where it is the same for every car."""
        wheels = range(self.wheels)
        return (
            *(f"x_{index}" for index in range(self.states)),
            *(f"road_height_m_{wheel}" for wheel in wheels),
            *(f"road_velocity_m_s_{wheel}" for wheel in wheels),
            "speed_m_s",
            *(f"preview_height_m_{wheel}_{time_s:g}s" for wheel in wheels for time_s in PREVIEW_TIMES_S),
        )

    def vector(self, estimate: Estimate, preview: RoadPreview | None) -> np.ndarray:
        """Observation, (len(names),) float32."""
        ahead_m = estimate.speed_m_s * np.array((0.0, *PREVIEW_TIMES_S))
        heights = np.zeros((self.wheels, len(PREVIEW_TIMES_S)))
        if preview is not None:
            rows = np.array([preview.height(wheel, ahead_m) for wheel in range(self.wheels)])
            heights = rows[:, 1:] - rows[:, :1]
        own = [estimate.x, estimate.road_height, estimate.road_velocity, [estimate.speed_m_s]]
        return np.concatenate([*own, heights.ravel()]).astype(np.float32)
