"""Multirate loop of a run: expose, sense, decide, actuate, integrate, event by event."""

from collections import deque
from collections.abc import Callable, Generator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from foreride.controller.interface import Estimate, MonitoredController
from foreride.controller.laws.passive import Constant
from foreride.controller.observer.exact_observer import ExactObserver
from foreride.controller.observer.observer import Observer
from foreride.controller.observer.sensor_monitor import SensorMonitor
from foreride.controller.registry import build
from foreride.controller.speed.control import SpeedControl
from foreride.preview.road_preview import PREVIEW_M, RoadPreview, within
from foreride.scenarios.cases import Case
from foreride.scenarios.definition.clock import TICKS_PER_SECOND, due, next_due, ticks
from foreride.scenarios.perceptions.interface import Event, Perception
from foreride.scenarios.perceptions.registry import perception_entry
from foreride.scenarios.simulation import preview_log
from foreride.scenarios.simulation.fault_injection import LATE_ANSWER, Faults
from foreride.scenarios.simulation.observer_errors import EstimateRecord
from foreride.vehicle.clock import STEP_S
from foreride.vehicle.equations import state_size
from foreride.vehicle.load import control_model
from foreride.vehicle.plant.difference import DeliveredReadings, Valves
from foreride.vehicle.plant.plant import Plant
from foreride.vehicle.plant.sensors import Sensors
from foreride.vehicle.state import VehicleState


class Decision(NamedTuple):
    """Request for a command: the time, the estimate of that time and the preview, if there is one."""

    time_s: float
    estimate: Estimate
    preview: RoadPreview | None


class MultirateLoop:
    """Scheduler of plant, perception and controller for one case; call `drive` once, then read the rest.

    `decisions` is the same drive for a caller who decides.

    events: detections, fallbacks and changes of the active constraints, in order of time; solver: the
    controller's counts, without its run times; timing: those run times; estimates: the observer's, one per
    decision; seen: the previews, 20 Hz; observer, sensors: those of the drive. For fixed dampers and a
    perception without an estimator neither
    sensors nor controller are evaluated: no estimates.
    """

    def __init__(
        self,
        case: Case,
        plant: Plant,
        sensors: Sensors | DeliveredReadings,
        perception: Perception,
        faults: Faults,
        controller: MonitoredController | None = None,
    ) -> None:
        """Build the controller named by the case unless `controller` is given."""
        scenario, car = case.scenario, case.scenario.vehicle.parameters
        control = scenario.control
        timing = control.timing
        known = control_model(car)
        self._controller = controller or build(case.controller, known, control.settings, timing)
        self.observer = None if scenario.observer == "truth" else Observer(known, scenario.sensors, timing)
        self._exact = ExactObserver(known)
        self._states = state_size(known)
        self._watch = SensorMonitor(car.wheels, scenario.sensors)
        self._plant, self.sensors, self._perception = plant, sensors, perception
        self._faults = faults
        different = scenario.plant
        self._delay = ticks(control.delay_s + different.actuation_delay_s)
        stroke_s = control.full_stroke_s if different.full_stroke_s is None else different.full_stroke_s
        self._valves = Valves(car, stroke_s, different.hysteresis)
        self._known_valves = Valves(car, control.full_stroke_s, 0.0)
        self._rate_hz, self._total = control.rate_hz, scenario.ticks
        self._command = np.array([corner.damping_passive_ns_m for corner in car.corners])
        self._waiting: deque[tuple[int, np.ndarray]] = deque()
        self._known_delay, self._believed = ticks(control.delay_s), self._command
        self._expected: deque[tuple[int, np.ndarray]] = deque()
        self._open_loop = False
        self._speed: SpeedControl | None = None
        if scenario.speed_planner:
            costs = scenario.speed_planner, known, scenario.speed_m_s, scenario.tyre_load_weight
            controlled = not isinstance(self._controller, Constant)
            self._speed = SpeedControl(*costs, timing.period_s, controlled)
            self._end_m = scenario.end_m
        has_estimator = perception_entry(case.perception).has_estimator
        if isinstance(self._controller, Constant) and not (has_estimator or self._speed):
            self._open_loop = True
            self._waiting.append((self._delay, self._controller.command))
        self.estimates = EstimateRecord()
        self._wheel = int(np.argmin(car.wheel_y_m))  # right front wheel
        self.seen: list[tuple[float, np.ndarray, np.ndarray]] = []
        self._active: tuple[str, ...] = ()
        self.events: list[Event] = []
        self.solver: dict[str, object] = {}
        self.timing: dict[str, float] = {}

    def drive(self, advance: Callable[[int], None]) -> None:
        """Run all ticks with the controller."""
        for _ in self.controlled(advance):
            pass
        stats = dict(self._controller.stats)
        self.timing = {
            name: stats.pop(name) for name in ("median_ms", "max_ms") if stats.get(name) is not None
        }
        self.solver = {name: value for name, value in stats.items() if name not in ("median_ms", "max_ms")}

    def controlled(self, advance: Callable[[int], None]) -> Generator[Decision, None, None]:
        """Run all ticks with the controller; each decision is yielded when its command is known."""
        decisions = self.decisions(advance)
        decision = next(decisions, None)
        while decision is not None:
            command = self._command_of_controller(decision)
            yield decision
            try:
                decision = decisions.send(command)
            except StopIteration:
                return

    def decisions(self, advance: Callable[[int], None]) -> Generator[Decision, np.ndarray | None, None]:
        """Run all ticks, from one event to the next; each decision yielded is answered with its command."""
        tick = 0
        while tick < self._total:
            state = self._plant.state
            self._perception.expose(tick, state)
            asked = not self._open_loop and due(tick, self._rate_hz)
            estimate = self._sense(tick, state) if asked else None
            self.events += self._perception.receive(tick)
            if estimate is not None:
                command = yield self._decision(tick, estimate, state)
                issued = np.asarray(command, dtype=float)
                self._waiting.append((tick + self._delay, issued))
                self._expected.append((tick + self._known_delay, issued))
            while self._waiting and self._waiting[0][0] <= tick:
                self._command = self._waiting.popleft()[1]
            following = self._next_event(tick)
            self._move(following - tick)
            advance(following - tick)
            tick = following

    def _move(self, count: int) -> None:
        """Advance the plant by `count` ticks; valves that are not ideal move in each of them."""
        if self._valves.ideal:
            self._plant.step(self._command, count)
            return
        for _ in range(count):
            self._plant.step(self._valves.advance(self._command, STEP_S))

    def _sense(self, tick: int, state: VehicleState) -> Estimate:
        """Read the sensors, before boxes of the same tick, which need the pose at their exposure."""
        reading = self._faults.reading(self.sensors.measure(state))
        self._controller.sensed(reading)
        checked = self._watch.check(reading)
        self._perception.sense(checked.measurement)
        forward_acc = self._speed.forward_acc if self._speed else None
        if self.observer is None:
            estimate = self._exact.update(replace(state, x=state.x[: self._states]))
            return replace(estimate, forward_acc=forward_acc or 0.0)
        while self._expected and self._expected[0][0] < tick:
            self._believed = self._expected.popleft()[1]
        known, period_s = self._known_valves, 1.0 / self._rate_hz
        acting = self._believed if known.ideal else known.advance(self._believed, period_s)
        estimate = self.observer.update(checked, acting, forward_acc)
        self.estimates.add(estimate)
        return estimate

    def _decision(self, tick: int, estimate: Estimate, state: VehicleState) -> Decision:
        time_s = tick / TICKS_PER_SECOND
        preview = self._faults.preview(self._perception.preview(time_s, state), time_s)
        if preview is not None and due(tick, preview_log.RATE_HZ):
            self.seen.append(preview_log.decimated(preview, self._wheel))
        if self._speed:
            estimate = self._plan_speed(tick, estimate, preview)
            preview = None if preview is None else within(preview, PREVIEW_M)
        if self._faults.late(time_s):
            estimate = replace(estimate, faults=(*estimate.faults, LATE_ANSWER))
        return Decision(time_s, estimate, preview)

    def _plan_speed(self, tick: int, estimate: Estimate, preview: RoadPreview | None) -> Estimate:
        """Have the car follow the planned speed; return the estimate with the acceleration that begins."""
        assert self._speed
        profile = self._speed.step(estimate, preview, tick, self._plant.state)
        if profile is not None:
            self._plant.follow(profile)
            self._total = tick + int(profile.time_at(self._end_m) * TICKS_PER_SECOND)
        return replace(estimate, forward_acc=self._speed.forward_acc)

    def _command_of_controller(self, decision: Decision) -> np.ndarray:
        command = self._controller.step(decision.estimate, decision.preview)
        if problem := self._controller.problem:
            self.events.append({"time_s": decision.time_s, "event": "fallback", "reason": problem})
        active = self._controller.active
        if active != self._active:
            self.events.append({"time_s": decision.time_s, "event": "constraints", "active": list(active)})
            self._active = active
        return command

    def _next_event(self, tick: int) -> int:
        asking = tick + TICKS_PER_SECOND if self._open_loop else next_due(tick, self._rate_hz)
        candidates = [self._total, asking]
        candidates += [when for when, _ in self._waiting]
        looked = self._perception.next_tick(tick)
        return min(candidates if looked is None else [*candidates, looked])
