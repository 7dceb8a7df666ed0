"""Laws of motion by second roads: differences, quadrature of the textbooks' accelerations, handbooks' peaks."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.cam.program.laws import LAWS, breaks_of, law_of, sine_constant_cosine

pi = np.pi
each_law = pytest.mark.parametrize("law", LAWS)

# Peaks of velocity, acceleration and jerk for rise 1 over angle 1, as the handbooks of cam design print them.
PEAKS = {
    "uniform": (1, 0, 0),
    "parabolic": (2, 4, 0),
    "harmonic": (pi / 2, pi**2 / 2, pi**3 / 2),
    "cycloidal": (2, 2 * pi, 4 * pi**2),
    "modified-trapezoid": (2, 8 * pi / (2 + pi), 32 * pi**2 / (2 + pi)),
    "modified-sine": (4 * pi / (4 + pi), 4 * pi**2 / (4 + pi), 16 * pi**3 / (4 + pi)),
    "3-4-5": (15 / 8, 10 / np.sqrt(3), 60),
    "4-5-6-7": (35 / 16, 84 * np.sqrt(5) / 25, 52.5),
}


@each_law
def test_peaks_are_those_of_the_handbooks(law):
    values = LAWS[law](np.linspace(0, 1, 100_001))
    assert np.abs(values[1:]).max(axis=1) == pytest.approx(PEAKS[law], rel=1e-8)


@each_law
def test_a_law_goes_from_0_to_1_and_starts_and_ends_at_rest_but_for_uniform(law):
    ends = LAWS[law](np.array([0.0, 1.0]))
    assert ends[0] == pytest.approx([0, 1], abs=1e-15)
    assert ends[1] == pytest.approx([1, 1] if law == "uniform" else [0, 0], abs=1e-14)
    if law not in ("uniform", "parabolic", "harmonic"):
        assert ends[2] == pytest.approx([0, 0], abs=1e-13)
    if law == "4-5-6-7":
        assert ends[3] == pytest.approx([0, 0], abs=1e-12)


@each_law
def test_each_row_is_the_derivative_of_the_row_before(law):
    x, h = np.linspace(0.0013, 0.9987, 499), 1e-4
    x = x[np.abs(x[:, None] - breaks_of(LAWS[law])).min(axis=1) > 2 * h]
    values = LAWS[law](x)
    # Five points: the error is that of the fifth derivative, 1e-16 of it, and of rounding, 1e-12.
    slope = sum(w * LAWS[law](x + k * h) for w, k in ((1, -2), (-8, -1), (8, 1), (-1, 2))) / (12 * h)
    for order in range(3):
        assert slope[order] == pytest.approx(values[order + 1], abs=2e-10 * max(1, np.abs(values[order + 1]).max()))


def trapezoid_of_sines(x):
    """The modified trapezoid's acceleration, of height 1, as the handbooks draw it eighth by eighth."""
    eighth = np.minimum((8 * x).astype(int), 7)
    up = np.sin(4 * pi * x)
    middle = np.cos(4 * pi * (x - 3 / 8))
    down = -np.cos(4 * pi * (x - 7 / 8))
    return np.select([eighth < 1, eighth < 3, eighth < 5, eighth < 7], [up, 1 + 0 * x, middle, -1 + 0 * x], down)


def sine_of_sines(x):
    """The modified sine's acceleration, of height 1: a fast sine in the outer eighths, a slow one between."""
    slow = np.sin(pi / 3 + 4 * pi / 3 * x)
    return np.select([x < 1 / 8, x < 7 / 8], [np.sin(4 * pi * x), slow], np.sin(4 * pi * x - 2 * pi))


@pytest.mark.parametrize(
    ("law", "acceleration"), [("modified-trapezoid", trapezoid_of_sines), ("modified-sine", sine_of_sines)]
)
def test_modified_laws_are_the_handbooks_acceleration_integrated_twice(law, acceleration):
    # Simpson's rule on 8000 steps whose joints are the law's; error 1e-15.
    n = 8000
    x = np.linspace(0, 1, 2 * n + 1)
    a = acceleration(x)

    def integral(y):
        return np.append(0, np.cumsum((y[:-2:2] + 4 * y[1:-1:2] + y[2::2]) / (6 * n)))

    fine = np.linspace(0, 1, 4 * n + 1)
    b = acceleration(fine)
    velocity = np.append(0, np.cumsum((b[:-2:2] + 4 * b[1:-1:2] + b[2::2]) / (12 * n)))
    lift = integral(velocity)
    scale = 1 / lift[-1]
    values = LAWS[law](x[::2])
    assert values[0] == pytest.approx(lift * scale, abs=1e-12)
    assert values[1] == pytest.approx(velocity[::2] * scale, abs=1e-11)
    assert values[2] == pytest.approx(a[::2] * scale, abs=1e-10)


@pytest.mark.parametrize("shares", [(0.2, 0.5, 0.3), (0.4, 0.6, 0)])
def test_any_law_of_sine_constant_cosine_has_the_acceleration_that_its_shares_draw(shares):
    """Of one height from the first sine's top to the last one's, and each row the sum of the next in small steps."""
    ramp, constant, swing = shares
    law, n = sine_constant_cosine(*shares), 4000
    x = (np.arange(n) + 0.5) / n
    _, slope, acceleration, jerk = law(x)
    ends = np.cumsum([ramp / 2, constant / 2, swing, constant / 2, ramp / 2])
    up, down = (np.sin(pi * y / (ramp or 1)) for y in (x, 1 - x))
    turning = np.cos(pi * (x - ends[1]) / (swing or 1))
    drawn = np.select([x < ends[0], x < ends[1], x < ends[2], x < ends[3]], [up, 1, turning, -1], -down)
    assert np.abs(acceleration - acceleration.max() * drawn).max() < 1e-12 * acceleration.max()
    edges = law(np.arange(n + 1) / n)
    assert edges[0, [0, -1]] == pytest.approx([0, 1], abs=1e-12)
    assert np.abs(edges[0] - np.append(0, np.cumsum(slope)) / n).max() < 1e-6
    assert np.abs(edges[1] - np.append(0, np.cumsum(acceleration)) / n).max() < 2e-6
    inside = np.min(np.abs(x[:, None] - ends), axis=1) > 2 / n
    assert np.abs(jerk - np.gradient(acceleration, x))[inside].max() < 1e-4 * (1 + np.abs(jerk).max())


class Kinked:
    """Half the way at speed 1.5, the rest at 0.5, with the joint kept quiet or not."""

    def __call__(self, x):
        slow = x >= 0.5
        return np.stack([np.where(slow, 0.5 + 0.5 * x, 1.5 * x), np.where(slow, 0.5, 1.5), 0 * x, 0 * x])


class WithBreaks(Kinked):
    breaks = (0, 0.5, 1)


@pytest.mark.parametrize(
    "law",
    [
        lambda x: x,
        lambda x: np.stack([2 * x, 2 + 0 * x, 0 * x, 0 * x]),
        lambda x: np.stack([x + 1e-5, 1 + 0 * x, 0 * x, 0 * x]),
        lambda x: np.stack([x**2, x, 1 + 0 * x, 0 * x]),
        lambda x: np.stack([x, 1.0001 + 0 * x, 0 * x, 0 * x]),
        lambda x: np.stack([x**2, 2 * x, 2 + 0 * x, 1 + 0 * x]),
        lambda x: np.stack([x, 1 + 0 * x, np.nan + 0 * x, 0 * x]),
        lambda x: np.stack([x, np.where(x == 1, np.inf, 1.0), 0 * x, 0 * x]),
        type("Late", (WithBreaks,), {"breaks": (0.1, 1)})(),
        type("Twice", (WithBreaks,), {"breaks": (0, 0.5, 0.5, 1)})(),
        type("None_", (WithBreaks,), {"breaks": ()})(),
        "cycloid",
        7,
    ],
)
def test_invalid_law_is_refused(law):
    with pytest.raises(gk.DesignError) as caught:
        law_of(law)
    assert caught.value.field.split(".")[0] == "law" and caught.value.remedy


@each_law
def test_breaks_run_from_0_to_1_alike_from_both_ends(law):
    breaks = breaks_of(LAWS[law])
    assert law_of(LAWS[law]) is LAWS[law] and law_of(law) is LAWS[law]
    assert breaks[0] == 0 and breaks[-1] == 1 and (np.diff(breaks) > 0).all()
    assert breaks == pytest.approx(1 - breaks[::-1], abs=1e-15)
    # Lift and velocity go through them.
    before, after = (LAWS[law](breaks[1:-1] + side)[:2] for side in (-1e-9, 1e-9))
    assert np.abs(after - before).max(initial=0) < 2e-8
