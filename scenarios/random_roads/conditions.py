"""Conditions of the robustness table: what the simulated car has and the controllers do not know.

Sizes are those met on the road: a full load is up to a third of the body's mass; tyre stiffness goes with
pressure and temperature; dampers lose a fifth and more of their force by age and temperature (J. C. Dixon,
The Shock Absorber Handbook, 2nd ed. 2007, ch. 4 and 7); accelerometers of cars are specified to some
hundredths of g over temperature and life. Valves: see docs/robustness.md. Conditions whose name ends in
"known" tell the same thing to the controllers.
"""

NOMINAL = "as known"
CONDITIONS: dict[str, tuple[str, ...]] = {
    NOMINAL: (),
    "body 25 % heavier": ("plant.sprung_mass_ratio=1.25",),
    "body 15 % lighter": ("plant.sprung_mass_ratio=0.85",),
    "springs 20 % stiffer": ("plant.spring_ratio=1.2",),
    "tyres 20 % softer": ("plant.tyre_ratio=0.8",),
    "dampers 25 % weaker": ("plant.rebound_force_ratio=0.75", "plant.compression_force_ratio=0.75"),
    "rebound 1.4, compression 0.6": ("plant.rebound_force_ratio=1.4", "plant.compression_force_ratio=0.6"),
    "the same, known": (
        "vehicle.parameters.damper={kind: scaled, rebound_ratio: 1.4, compression_ratio: 0.6}",
    ),
    "damper lag 20 ms": ("plant.damper_lag_s=0.02",),
    "full stroke 20 ms": ("plant.full_stroke_s=0.02",),
    "full stroke 80 ms": ("plant.full_stroke_s=0.08",),
    "full stroke 80 ms, known": ("control.full_stroke_s=0.08",),
    "hysteresis 5 %": ("plant.hysteresis=0.05",),
    "delay 15 ms": ("plant.actuation_delay_s=0.015",),
    "delay 15 ms, known": ("control.delay_s=0.015",),
    "readings 10 ms late": ("plant.sensor_delay_readings=2",),
    "readings at 100 Hz": ("plant.sensor_rate_hz=100",),
    "accelerometers 0.3 m/s² off": ("plant.body_acc_bias_m_s2=0.3",),
    "level sensors 5 mm off": ("plant.rattle_bias_m=0.005",),
}
"""Overrides of each condition."""
