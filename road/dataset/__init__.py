"""Labelled image sets rendered from random roads, in YOLO layout."""
