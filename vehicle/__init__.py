"""Quarter-, half- and full-car models: parameters, equations of motion, plant, sensors, linear twin."""
