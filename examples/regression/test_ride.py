"""Ride regression test of your car: `pytest --ride-accept` once, commit `ride_baselines/`, then `pytest`."""

import numpy as np


def test_the_hump_stays_comfortable(ride_comfort):
    run = ride_comfort("hump_flat_30", perception="oracle", overrides={"vehicle.model": "quarter"})
    assert run.metrics["lift_time"] < 0.1


def test_the_firm_damper_is_as_firm_as_it_was(ride_comfort):
    run = ride_comfort("short_bump.yaml", controller="passive", tolerances={"wk_rms": 0.01})
    assert np.abs(run.signals["rattle_m_0"]).max() < 0.06
