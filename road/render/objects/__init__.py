"""Objects beside and on the road: vehicles, people, trees, poles and houses."""
