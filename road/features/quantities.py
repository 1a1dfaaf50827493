"""Value ranges of feature dimensions, with units."""

from typing import Annotated

from annotated_types import Interval

Position = Annotated[float, Interval(ge=-1e6, le=1e6), "m"]
Lateral = Annotated[float, Interval(ge=-50.0, le=50.0), "m"]
Length = Annotated[float, Interval(ge=1e-3, le=20.0), "m"]
Height = Annotated[float, Interval(ge=1e-4, le=0.5), "m"]
Ramp = Annotated[float, Interval(ge=1e-4, le=20.0), "m"]
Taper = Annotated[float, Interval(ge=0.0, le=50.0), "m"]
