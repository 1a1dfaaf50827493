"""Ego motion at sensor rate: odometry, heave and pitch, roll, path and changes of grade."""
