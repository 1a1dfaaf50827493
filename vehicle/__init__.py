"""Quarter, half and full car: parameters, equations, the MuJoCo plant, its sensors and its linear twin."""
