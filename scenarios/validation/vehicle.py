"""Validation of the vehicle: statics, frequency responses, transients, energy, dampers."""

from scenarios.validation.check import Checks

CHECKS: Checks = ()
