"""Suspension controllers: state estimate and road preview to damper settings and actuator forces."""
