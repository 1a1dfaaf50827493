"""Prediction of the car in a controller: its model, and the machine code of that model."""
