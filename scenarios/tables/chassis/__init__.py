"""Studies of the chassis: speed planned for comfort, stopping on rough roads, actuators."""
