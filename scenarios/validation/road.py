"""Validation of the road: profiles, roughness, tyre envelope, files, IRI."""

from scenarios.validation.check import Checks

CHECKS: Checks = ()
