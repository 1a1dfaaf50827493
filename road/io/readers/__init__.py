"""Readers of road files, a module per format; `road.io.formats` lists them."""
