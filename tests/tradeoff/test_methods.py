"""Every method finds what its family asks for: its errors at every setting against bounds known beforehand."""

from functools import cache

import numpy as np
import pytest

from geomkin.tradeoff.families import FAMILIES

# Largest error of each method at its settings, from the first to the last. A bound is about three times what the
# method is known to miss: of rounding, of the power of a step, of the terms left out.
BOUNDS = {
    "four-bar-position": {
        "geomkin.move": [2e-15],
        "toggle-proof form, plain NumPy": [2e-15],
        "general dyad solver": [2e-15],
        "unit vectors": [2e-15],
        "half-angle (Freudenstein)": [4e-15],
        "diagonal and cosine rule": [4e-15],
        "single precision": [1e-6],
        "Newton, cold": [0.1, 5e-3, 3e-6, 1e-11, 2e-15, 2e-15],
        "Newton, warm": [1e-3, 1e-9, 2e-15],
        "root finder per frame": [1e-7, 2e-15],
        "linear table": [1e-3, 1e-5, 1e-7],
        "cubic table": [1e-5, 1e-9, 1e-13],
    },
    "four-bar-rates": {
        "geomkin.move": [2e-15],
        "toggle-proof form, plain NumPy": [2e-15],
        "general dyad solver": [2e-15],
        "loop equations on unit vectors": [2e-15],
        "loop equations, exact positions": [2e-15],
        "single precision": [1e-6],
        "differences of positions": [1e-4, 2e-7, 4e-10, 1e-8, 3e-7],
    },
    "new-lengths": {
        "geomkin.move": [2e-15],
        "geomkin.move, arrays of lengths": [2e-15],
        "plain NumPy": [2e-15],
        "plain NumPy, arrays of lengths": [2e-15],
        "single precision": [1e-6],
        "frame by frame": [2e-15],
    },
    "derivatives": {
        "motion.sensitivity": [2e-15],
        "loop equation by hand, plain NumPy": [2e-15],
        "complex step": [2e-15],
        "central differences, order 2": [0.06, 6e-4, 6e-6, 6e-8, 2e-9, 2e-7],
        "central differences, order 4": [0.01, 1e-6, 1e-10, 2e-11, 2e-9, 2e-7],
        "central differences of geomkin.move": [0.06, 6e-4, 6e-6, 6e-8, 2e-9, 2e-7],
    },
    "velocity-from-positions": {
        "exact coefficients (geomkin.move)": [2e-15],
        "velocity differences": [0.01, 2.5e-3, 4e-4, 1e-4],
        "central differences, order 2": [0.04, 0.01, 1.6e-3, 4e-4, 1e-4, 4e-6],
        "central differences, order 4": [2e-3, 1.2e-4, 3.2e-6, 2e-7, 1.2e-8, 2e-11],
        "central differences, order 6": [2e-4, 4e-6, 2e-8, 3e-10, 5e-12, 3e-12],
        "cubic spline": [4e-4, 2.5e-5, 6e-7, 4e-8, 2.5e-9, 4e-12],
        "Fourier series": [5e-9, 1e-12, 1e-12, 1e-12, 2e-12, 6e-12],
        "tangents drawn": [0.2, 0.05, 0.05, 0.1],
        "mid-ordinates drawn": [0.1, 0.05, 0.05, 0.15],
    },
    "acceleration-from-positions": {
        "exact coefficients (geomkin.move)": [3e-15],
        "velocity differences": [0.03, 8e-3, 1.3e-3, 3e-4],
        "central differences, order 2": [0.03, 8e-3, 1.3e-3, 3e-4, 8e-5, 4e-6],
        "central differences, order 4": [2e-3, 1.2e-4, 3e-6, 2e-7, 2e-8, 3e-9],
        "central differences, order 6": [2e-4, 4e-6, 2e-8, 4e-10, 2e-10, 5e-9],
        "cubic spline": [0.03, 8e-3, 1.3e-3, 3e-4, 8e-5, 4e-6],
        "Fourier series": [7e-9, 1e-11, 5e-11, 2e-10, 5e-10, 8e-9],
        "tangents drawn": [0.5, 0.2, 0.2, 1.2],
        "mid-ordinates drawn": [0.15, 0.2, 0.8, 5],
    },
    "positions-from-velocities": {
        "exact positions (geomkin.move)": [2e-15],
        "mid-ordinates": [3e-3, 8e-4, 1.3e-4, 3e-5, 8e-6, 3e-7],
        "trapezoids": [6e-3, 1.5e-3, 2.5e-4, 6e-5, 1.5e-5, 6e-7],
        "Simpson's rule": [6e-5, 4e-6, 1e-7, 6e-9, 4e-10, 1e-12],
        "trapezoids with end correction": [2e-4, 1e-5, 3e-7, 2e-8, 1e-9, 2e-12],
        "Fourier series": [4e-10, 2e-15, 2e-15, 2e-15, 2e-15, 2e-15],
    },
    "slider-crank-position": {
        "geomkin.move": [2e-13],
        "general dyad solver": [1e-13],
        "product of factors": [5e-14],
        "root of a difference of squares": [5e-14],
        "angle of the rod": [5e-14],
        "single precision": [5e-5],
        "series": [1.5, 0.15, 0.02, 3e-4, 3e-7],
        "Newton, cold": [2, 0.005, 1e-7, 5e-14],
        "frame by frame": [5e-14],
        "linear table": [0.06, 6e-4, 6e-6],
        "cubic table": [7e-5, 7e-9, 1e-12],
    },
    "six-bar-position": {
        "geomkin.move": [5e-15],
        "general dyad solver": [5e-15],
        "unit vectors": [5e-15],
        "single precision": [2e-6],
        "Newton, cold": [0.5, 3e-4, 5e-15, 5e-15],
        "root finder per frame": [1e-7, 1e-14, 5e-15],
        "the library's iteration": [5e-15],
        "linear table": [3e-3, 3e-5, 3e-7],
        "cubic table": [4e-5, 4e-9, 5e-13],
    },
    "iteration": {
        "geomkin.move": [2e-14],
        "Newton, cold": [2, 2, 2, 2, 2],
        "root finder per frame": [1e-6, 1e-12, 2e-14],
        "dyads backwards, by halving": [2e-3, 2e-6, 5e-11, 2e-14],
        "dyads backwards, by secants": [0.05, 1e-3, 1e-11, 2e-14],
        "table read backwards": [3e-4, 3e-6, 3e-8],
    },
}  # fmt: skip


@cache
def problem(name):
    return FAMILIES[name].problem()


@pytest.mark.parametrize(("family", "method"), [(f, m) for f, methods in BOUNDS.items() for m in methods])
def test_errors_are_as_small_as_the_method_makes_them(family, method):
    one = FAMILIES[family]
    (way,) = [m for m in one.methods if m.name == method]
    bounds = BOUNDS[family][method]
    for setting, bound in zip(way.settings or (np.nan,), bounds, strict=True):
        found = way.make(problem(family), setting)()
        errors = one.error(problem(family), found)
        assert one.count(problem(family), found) > 40 and len(errors) > 9
        assert errors.max() <= bound, (setting, errors.max())


@pytest.mark.parametrize("family", ["four-bar-toggle", "four-bar-toggle-rates"])
def test_near_the_toggle_only_the_toggle_proof_form_keeps_its_digits(family):
    one = FAMILIES[family]
    worst = {}
    for method in one.methods:
        if not method.settings and method.name != "single precision":
            found = method.make(problem(family), np.nan)()
            worst[method.name] = float(one.error(problem(family), found).max())
    kept = {name for name, error in worst.items() if error < 2e-15}
    assert kept == {"geomkin.move", "toggle-proof form, plain NumPy"}
    textbook = "unit vectors" if family == "four-bar-toggle" else "loop equations on unit vectors"
    assert worst[textbook] > (1e-13 if family == "four-bar-toggle" else 1e-9)


def test_newton_from_one_far_pose_goes_astray_at_some_frames_alone():
    one = FAMILIES["iteration"]
    (cold,) = [m for m in one.methods if m.name == "Newton, cold"]
    errors = one.error(problem("iteration"), cold.make(problem("iteration"), 12.0)())
    assert 0.5 < np.mean(errors < 2e-14) < 1


def test_the_error_of_a_pose_is_that_of_the_worse_of_its_two_angles():
    one, right = FAMILIES["four-bar-position"], problem("four-bar-position").directions
    bar, rocker = (z.copy() for z in right)
    bar[7] *= np.exp(1e-3j)
    bar[9] *= np.exp(-2e-3j)
    rocker[9] *= np.exp(5e-3j)
    rocker[11] = np.nan
    errors = one.error(problem("four-bar-position"), (bar, rocker))
    assert errors[[7, 9]] == pytest.approx([1e-3, 5e-3], rel=1e-5) and np.isnan(errors[11])
    assert np.flatnonzero(errors != 0).tolist() == [7, 9, 11] and one.count(problem("four-bar-position"), right) == 360


def test_the_error_of_rates_is_that_of_the_worst_of_the_four_as_its_share():
    """As a share of 1 where the value is smaller; what is off by more than itself was not found."""
    one, given = FAMILIES["four-bar-toggle-rates"], problem("four-bar-toggle-rates")
    right = [*given.first, *given.second]
    sizes = np.abs(np.stack(right))
    for which in range(4):
        small, large = int(np.argmax(sizes[which] < 0.5)), int(np.argmax(sizes[which]))
        found = [rate.copy() for rate in right]
        found[which][small] += 0.25
        # A smaller slip of another rate of the same pose does not show.
        found[(which + 1) % 4][small] -= 0.125
        wrong, shares = [small], [0.25]
        if which >= 2:
            assert sizes[which][large] > 1e4
            found[which][large] *= 1.75
            wrong, shares = [small, large], [0.25, 0.75]
        errors = one.error(given, tuple(found))
        assert errors[wrong] == pytest.approx(shares)
        assert sorted(np.flatnonzero(errors != 0).tolist()) == sorted(wrong)
        for much in (1.01, np.inf, np.nan):
            found[which][small] = right[which][small] + much
            assert np.isnan(one.error(given, tuple(found))[small])


@pytest.mark.parametrize("step", [0.5, 10.0])
def test_errors_of_samples_are_those_at_whole_degrees(step):
    rates = problem("velocity-from-positions")
    at = np.arange(3600) * step
    for name, right in (
        ("velocity-from-positions", rates.first[1]),
        ("acceleration-from-positions", rates.second[1]),
        ("positions-from-velocities", np.angle(rates.directions[1])),
    ):
        values = np.interp(at % 360, np.arange(361), np.append(right, right[0]))
        size = 1.0 if name.startswith("positions") else np.abs(right).max()
        # At 20 deg, on a later turn, and between two whole degrees where steps are half ones.
        values[int(20 / step)] += 0.1
        values[-int(10 / step)] -= 0.2
        values[1] += 0.3
        errors = FAMILIES[name].error(rates, (values, step))
        reported = sorted(errors[errors > 1e-12].tolist())
        assert reported == pytest.approx(np.array([0.1, 0.2, *[0.3] * (step >= 1)]) / size)
        assert len(errors) == (1800 if step < 1 else 3600)


def test_the_error_of_a_track_is_the_distance_from_the_right_value():
    one, given = FAMILIES["six-bar-position"], problem("six-bar-position")
    found = given.right.copy()
    found[5] += 3e-3 + 4e-3j
    found[-1] -= 1e-3
    errors = one.error(given, found)
    assert np.flatnonzero(errors).tolist() == [5, 359] and errors[[5, -1]] == pytest.approx([5e-3, 1e-3])


def test_the_error_of_new_lengths_is_that_of_the_worst_of_place_velocity_and_acceleration():
    one, given = FAMILIES["new-lengths"], problem("new-lengths")
    found = np.repeat(given.right, 6, axis=2)
    scales = np.abs(given.right).max(axis=(0, 2))
    found[2, :, 30] += np.array([1e-3, 4e-3, 2e-3]) * scales
    found[3, 0, 31] += 1  # between two frames with a reference
    errors = one.error(given, found)
    assert np.flatnonzero(errors).tolist() == [2 * 60 + 5] and errors.max() == pytest.approx(4e-3)
    assert one.count(given, found) == 3600


def test_the_error_of_derivatives_is_a_share_of_the_largest_by_the_same_length():
    one, given = FAMILIES["derivatives"], problem("derivatives")
    found = np.repeat(given.right, 6, axis=1)
    found[[1, 3], 12] += 1e-3 * np.abs(given.right).max(axis=1)[[1, 3]] * np.array([1, 2j])
    errors = one.error(given, found)
    assert np.flatnonzero(errors).tolist() == [62, 182] and errors[[62, 182]] == pytest.approx([1e-3, 2e-3])
    assert one.count(given, found) == 1440
