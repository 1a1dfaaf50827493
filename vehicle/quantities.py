"""Ranges of a car's quantities, from model cars to trucks, with their units."""

from typing import Annotated

from annotated_types import Interval

BodyMass = Annotated[float, Interval(ge=0.1, le=50_000.0), "kg"]
Inertia = Annotated[float, Interval(ge=1e-4, le=2e6), "kg·m²"]
UnsprungMass = Annotated[float, Interval(ge=0.01, le=2000.0), "kg"]
AxleDistance = Annotated[float, Interval(ge=0.05, le=10.0), "m"]
Height = Annotated[float, Interval(ge=0.0, le=4.0), "m"]
Seat = Annotated[float, Interval(ge=-10.0, le=10.0), "m"]
WheelRadius = Annotated[float, Interval(ge=0.02, le=1.5), "m"]
Track = Annotated[float, Interval(ge=0.2, le=4.0), "m"]
Spring = Annotated[float, Interval(ge=1.0, le=5e6), "N/m"]
CubicSpring = Annotated[float, Interval(ge=0.0, le=1e8), "N/m³"]
TyreStiffness = Annotated[float, Interval(ge=10.0, le=2e7), "N/m"]
AntiRoll = Annotated[float, Interval(ge=0.0, le=5e6), "N/m"]
TyreDamping = Annotated[float, Interval(ge=0.0, le=1e5), "N·s/m"]
PositiveDamping = Annotated[float, Interval(ge=0.1, le=5e5), "N·s/m"]
Damping = Annotated[float, Interval(ge=0.0, le=5e5), "N·s/m"]
Gap = Annotated[float, Interval(ge=1e-3, le=0.5), "m"]
Stop = Annotated[float, Interval(ge=1.0, le=1e8), "N/m²"]
Lag = Annotated[float, Interval(ge=1e-3, le=0.5), "s"]
Current = Annotated[float, Interval(ge=0.0, le=100.0), "A"]
StrutSpeed = Annotated[float, Interval(ge=1e-3, le=20.0), "m/s"]
StrutForce = Annotated[float, Interval(ge=0.0, le=1e6), "N"]
SignedForce = Annotated[float, Interval(ge=-1e5, le=1e5), "N"]
Viscous = Annotated[float, Interval(ge=0.0, le=1e6), "N·s/m"]
