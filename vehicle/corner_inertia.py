"""Inertia of the car as its tyres carry it: masses and inertias reduced to the corners."""

import numpy as np

from foreride.vehicle.load import Car


def corner_inertia(vehicle: Car) -> np.ndarray:
    """Matrix (w, 2w), kg: tyre forces beyond the static ones per acceleration of body corners, then wheels.

    With more wheels than body motions it gives the forces of least squares, without the part that cancels in
    the body (warp).
    """
    kinematic_rows = np.array([corner.kinematic_row for corner in vehicle.corners])
    force_distribution = np.linalg.pinv(kinematic_rows.T)
    body = force_distribution @ np.diag(vehicle.generalised_mass) @ np.linalg.pinv(kinematic_rows)
    return np.hstack([body, np.diag([corner.unsprung_mass_kg for corner in vehicle.corners])])
