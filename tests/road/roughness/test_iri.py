import numpy as np
import pytest
from scipy.integrate import solve_ivp

from foreride.files.errors import InputError
from foreride.road.roughness.iri import SPEED_M_S, iri, rectified_slope, response, transition
from foreride.road.roughness.iso8608 import STEP_M, Roughness, displacement_psd, rough_surface
from foreride.road.roughness.world_bank_46 import WORLD_BANK_46


@pytest.mark.parametrize("step", sorted(WORLD_BANK_46))
def test_transition_matrices_are_the_published_ones(step):
    phi, gamma = transition(step)
    np.testing.assert_allclose(phi, WORLD_BANK_46[step][0], rtol=2e-6)
    np.testing.assert_allclose(gamma, WORLD_BANK_46[step][1], rtol=1e-6, atol=4e-7)


@pytest.mark.parametrize("wavelength", [1.5, 2.4, 5.0, 15.4, 40.0])
def test_sinusoid_has_the_golden_cars_gain(wavelength):
    step, amplitude, n = 0.05, 0.002, 1 / wavelength
    x = np.arange(0, 2000 * wavelength, step)[:200_000]
    measured = iri(amplitude * np.sin(2 * np.pi * n * x), step)
    filters = np.sinc(0.25 * n) * np.sinc(step * n)  # the 250 mm mean, and slopes held over a step
    expected = 2 / np.pi * amplitude * 2 * np.pi * n * abs(response(n)) * filters * 1000
    assert measured == pytest.approx(expected, rel=0.003)


def test_gain_follows_from_the_equations_of_motion_integrated():
    """Mean |stroke slope| on a sinusoid, by a general-purpose integrator without a transition matrix."""
    n, amplitude = 1 / 6.0, 0.003
    omega = 2 * np.pi * n * SPEED_M_S

    def rates(t: float, state: np.ndarray) -> list[float]:
        body, body_v, wheel, wheel_v = state
        strut = 63.3 * (wheel - body) + 6.0 * (wheel_v - body_v)
        return [body_v, strut, wheel_v, (653.0 * (amplitude * np.sin(omega * t) - wheel) - strut) / 0.15]

    t = np.linspace(0, 30, 60_001)
    simulated = solve_ivp(rates, (0, 30), [0, 0, 0, 0], t_eval=t, rtol=1e-9, atol=1e-12).y[:, t > 10]
    stroke = np.mean(np.abs(simulated[1] - simulated[3])) / SPEED_M_S
    assert stroke == pytest.approx(2 / np.pi * amplitude * 2 * np.pi * n * abs(response(n)), rel=1e-3)


@pytest.mark.parametrize("iso_class", ["A", "C"])
def test_iso_class_has_the_iri_that_its_psd_gives(iso_class):
    """IRI = 2.21 sqrt(G_d(Omega_0) / 1e-6 m³) for waviness 2 (Kropac and Mucka); class A has 1e-6 m³."""
    roughness = Roughness(iso_class, seed=4)
    measured = iri(rough_surface(roughness, 4000.0).heights[4], STEP_M)
    assert measured == pytest.approx(2.21 * np.sqrt(roughness.psd_n0_m3 / 16e-6), rel=0.05)
    n = np.linspace(0.01, 10, 200_000)
    slope_psd = (2 * np.pi * n) ** 2 * displacement_psd(roughness, n) * np.sinc(0.25 * n) ** 2
    variance = np.trapezoid(np.abs(response(n)) ** 2 * slope_psd, n)
    assert measured == pytest.approx(1000 * np.sqrt(2 / np.pi * variance), rel=0.04)


def test_grade_and_level_do_not_count_and_height_counts_in_proportion():
    z = rough_surface(Roughness("B", 1), 300.0).heights[5, :10_000]
    x = STEP_M * np.arange(len(z))
    base = iri(z, STEP_M)
    assert iri(z + 5.0 + 0.03 * x, STEP_M) == pytest.approx(base, rel=1e-9)
    assert iri(2.5 * z, STEP_M) == pytest.approx(2.5 * base, rel=1e-12)
    assert iri(0.03 * x, STEP_M) == pytest.approx(0.0, abs=1e-9)


def test_state_recursion_step_by_step_gives_the_same():
    z = rough_surface(Roughness("C", 1), 300.0).heights[5, ::12][:500]
    step = 12 * STEP_M
    phi, gamma = transition(step)
    start = (z[46] - z[0]) / (46 * step)
    state, total = np.array([start, 0, start, 0]), []
    for slope in np.diff(z) / step:
        state = phi @ state + gamma * slope
        total.append(abs(state[0] - state[2]))
    np.testing.assert_allclose(rectified_slope(z, step), total, rtol=1e-9)


def sayers(z: np.ndarray, step: float) -> float:
    """IRI by the program of Sayers 1995, TRR 1501, point by point with a buffer of K heights."""
    k = max(2, int(0.25 / step + 0.5) + 1)
    phi, gamma = map(np.array, WORLD_BANK_46[step] if step in WORLD_BANK_46 else transition_by_series(step))
    eleven_m = int(11 / step + 0.5)
    buffer, rest = list(z[:k]), z[k:]
    state = np.array([(z[eleven_m] - z[0]) / (eleven_m * step), 0.0] * 2)
    total = count = 0.0
    while True:
        state = phi @ state + gamma * ((buffer[-1] - buffer[0]) / ((k - 1) * step))
        total, count = total + abs(state[0] - state[2]), count + 1
        if not len(rest):
            return 1000 * total / count
        buffer, rest = [*buffer[1:], rest[0]], rest[1:]


def transition_by_series(step: float) -> tuple[np.ndarray, np.ndarray]:
    """Transition matrices by Sayers' Taylor series, from the golden car's numbers."""
    a = np.array(
        [[0, 1, 0, 0], [-63.3, -6, 63.3, 6], [0, 0, 0, 1], [422.0, 40.0, -(653 + 63.3) / 0.15, -40.0]]
    )
    phi, term = np.eye(4), np.eye(4)
    for order in range(1, 60):
        term = term @ a * (step / SPEED_M_S / order)
        phi = phi + term
    return phi, np.linalg.solve(a, (phi - np.eye(4)) @ [0.0, 0.0, 0.0, 653 / 0.15])


@pytest.mark.parametrize(
    "step", [0.01, 0.02, 0.05, 0.25 / 4.5, 0.07, 0.1, 0.125, 0.15, 0.1667, 0.2, 0.25, 0.3]
)
def test_profiles_have_the_iri_of_sayers_program(step):
    rng = np.random.default_rng(5)
    x = np.arange(0.0, 60.0, step)
    rough = np.interp(x, np.arange(0, 61, 0.05), np.cumsum(rng.normal(size=1220)) * 1e-3)
    for z in (rough + 0.02 * x, 0.005 * np.sin(np.pi * x)):
        assert iri(z, step) == pytest.approx(sayers(z, step), rel=2e-5 if step in WORLD_BANK_46 else 1e-9)


@pytest.mark.parametrize(
    ("heights", "step", "message"),
    [
        (np.zeros(100), 0.5, "^step_m must be > 0 and <= 0.3, got 0.5"),
        (np.zeros(40), 0.25, "^IRI: road must be >= 11 m long, got 9.75 m"),
        (np.full(400, np.nan), 0.1, "^heights must be"),
    ],
)
def test_bad_input_names_the_field(heights, step, message):
    with pytest.raises(InputError, match=message):
        iri(heights, step)
