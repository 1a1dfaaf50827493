"""Commands that inspect inputs and results: road, render, perception, report and calibrate."""
