"""Height-field renderer: image, depth and exact boxes from the same ray hits."""
