"""Plant: the car in MuJoCo, its sensors, and fleets of cars."""
