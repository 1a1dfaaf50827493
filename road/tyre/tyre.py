"""Tyre: radius and enveloping model, which together turn road height into effective height."""

from dataclasses import dataclass, field
from typing import Annotated

import numpy as np
from annotated_types import Interval
from numpy.typing import ArrayLike, NDArray

from foreride.files.reading.ranges import Checked
from foreride.road.tyre.contact_models import Enveloping, RigidWheel
from foreride.road.tyre.wheel_profile import PATCH_M, WHEEL_RADIUS_M


@dataclass(frozen=True)
class Tyre(Checked):
    """Tyre of radius `radius_m` with an enveloping model."""

    radius_m: Annotated[float, Interval(ge=0.0, le=2.0), "m"] = WHEEL_RADIUS_M
    enveloping: Enveloping = field(default_factory=lambda: RigidWheel(PATCH_M))

    def effective_height(self, heights: ArrayLike, step_m: float) -> NDArray[np.float64]:
        """Effective heights (..., n) of `heights` (m) every `step_m` along x, constant beyond both ends."""
        return self.enveloping.effective_height(heights, step_m, self.radius_m)
