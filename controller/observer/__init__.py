"""State observer: sensor monitoring and the kinematic Kalman filter."""
