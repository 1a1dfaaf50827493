"""Subcommands of `foreride`, each in a module with `configure(parser)` and the function that it executes.

This table holds what `foreride --help` shows; a command's module is imported when the command is used.
"""

COMMANDS: dict[str, tuple[str, str]] = {
    "demo": ("drive.demo", "the whole loop on three events: table, figure and video"),
    "run": ("drive.run", "simulate one scenario and write a run folder"),
    "compare": ("drive.compare", "compare controllers and perceptions on scenarios"),
    "sweep": ("drive.sweep", "run all drives of a study, in parallel and resumable"),
    "front": ("drive.front", "Pareto fronts of comfort, tyre load and travel on random roads"),
    "regress": ("drive.regress", "check ride metrics against a committed baseline"),
    "bound": ("drive.bound", "lower bound of J on a scenario, for any controller"),
    "tune": ("drive.tune", "tune the reactive controllers on a set of roads"),
    "perception": (
        "inspect.perception",
        "errors of distance, timing, shape and existence, on a scenario or on roads with many obstacles",
    ),
    "calibrate": ("inspect.calibrate", "a camera's intrinsics from photographs of a checkerboard"),
    "render": ("inspect.render", "write the camera's images along a scenario"),
    "report": ("inspect.report", "a run or a comparison as one HTML file or a video"),
    "log": ("inspect.log", "a run as a file of measurement and robotics tools (extra: logs)"),
    "replay": (
        "inspect.replay",
        "recorded images and signals through detector and estimator (extra for MCAP and MF4: logs)",
    ),
    "road": ("inspect.road", "length, IRI, ISO 8608 class and features of a road"),
    "list": ("inspect.listing", "scenarios, vehicles, controllers and other names that are accepted"),
    "detector": ("detector", "data, training, evaluation and export of the detector"),
    "fmu": ("fmu", "the car, the controller or the loop as a functional mock-up unit (FMI)"),
    "table": ("table", "tables of the documentation, measured anew"),
    "validation": ("validation", "compare with closed forms, standards, other programs"),
    "doctor": ("doctor", "check this installation"),
}
"""Module in this package, and help line, of each command by its name."""
