"""Identification on line: body mass, damper strength and delay of the commands, from the body's motion."""
