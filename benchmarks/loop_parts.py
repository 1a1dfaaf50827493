"""Parts of a drive for `benchmarks.bench_loop --profile`, each with the functions whose time it is."""

from collections.abc import Mapping
from itertools import groupby

_FUNCTIONS = {
    "set-up": ["scenarios.simulation.simulate:assembled", "scenarios.simulation.referenced_files:hashes"],
    "render: map tiles of the ground": ["road.render.ground_map:Surface.extend"],
    "render: rays to the ground": ["road.render.scene:Scene._trace"],
    "render: colour of ground and background": ["road.render.scene:colour"],
    "render: objects": ["road.render.draw_objects:draw"],
    "render: weather and lens": ["road.render.optics.exposure:Sensor.expose"],
    "render: sensor": ["road.render.optics.image_sensor:develop"],
    "render: true boxes, rest": ["road.render.scene:Scene.render"],
    "detector: graph": ["detector.runtime:Detector.candidates"],
    "detector: decode": ["detector.runtime:Detector.__call__"],
    "detector: NMS": ["detector.nms:select"],
    "preview: true boxes": [
        "road.render.outline_boxes:Outlines.boxes",
        "detector.box_errors:degrade",
    ],
    "preview: estimator, boxes": ["preview.estimator:Estimator.update_boxes"],
    "preview: estimator, motion": ["preview.estimator:Estimator.update_motion"],
    "preview: estimator, preview": ["preview.estimator:Estimator.preview"],
    "preview: oracle": ["scenarios.perceptions.oracle:OraclePerception.preview"],
    "observer": [
        "controller.observer.observer:Observer.update",
        "controller.observer.exact_observer:ExactObserver.update",
        "controller.observer.sensor_monitor:SensorMonitor.check",
    ],
    "MPC: prepare, road": [
        "controller.road_ahead.road_reference:RoadReference.update",
        "controller.road_ahead.road_reference:RoadReference.roads",
        "controller.road_ahead.wheelbase_preview:WheelbasePreview.update",
    ],
    "MPC: prepare, program": [
        "controller.mpc.linearisation:Linearisation.along",
        "controller.mpc.program:Program.condensed",
        "controller.mpc.controller:PredictiveController._predict",
    ],
    "MPC: QP": ["controller.mpc.riccati:solve_stages", "controller.mpc.program:Program.solve"],
    "MPC: rest of the step": ["controller.mpc.controller:PredictiveController.step"],
    "supervision": [
        "controller.supervision.supervisor:FallbackSupervisor.step",
        "controller.supervision.preview_gate:PreviewGate.check",
    ],
    "plant: step": ["vehicle.plant.plant:Plant.step"],
    "plant: state": ["vehicle.plant.plant:Plant.state"],
    "plant: sensors": ["vehicle.plant.difference:DeliveredReadings.measure"],
    "logging": [
        "vehicle.plant.plant:Plant.signals",
        "scenarios.simulation.simulate:metrics_of",
        "scenarios.simulation.recorded_signals:RecordedSignals.whole",
        "scenarios.simulation.observer_errors:observer_errors",
        "scenarios.simulation.preview_log:decimated",
        "scenarios.simulation.preview_log:collect",
    ],
    "writing": ["scenarios.runs.write:write"],
    "loop": ["scenarios.simulation.multirate_loop:MultirateLoop.drive"],
}
PARTS = {part: [f"foreride.{name}" for name in names] for part, names in _FUNCTIONS.items()}
"""Functions by part; time in one that calls another counts for the inner one."""


def with_sums(values: Mapping[str, float]) -> dict[str, float]:
    """The values by part, each group of several parts (what stands before the colon) led by its sum."""
    rows: dict[str, float] = {}
    for group, parts in groupby(values, lambda part: part.partition(":")[0]):
        members = list(parts)
        if len(members) > 1:
            rows[group] = sum(values[part] for part in members)
        rows |= {part: values[part] for part in members}
    return rows
