"""Reports of runs and comparisons: tables, figures, HTML and video."""
