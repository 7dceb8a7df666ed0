"""Every method finds what its family asks for: its error is the kept one, and falls as its order says."""

import numpy as np
import pytest

from geomkin.tradeoff.families import FAMILIES
from tests.campaign import by_default
from tests.tradeoff import kept
from tests.tradeoff.measured import errors, found, method, problem

# Largest errors that are kept, by family, method and setting.
KEPT = {
    (row["family"], row["method"], float(row["setting"] or "nan")): [
        float(row[name] or "nan") for name in ("largest_error", "missed_share")
    ]
    for row in kept.table("chart.csv")
}
# Tolerances and nine points are younger than the kept chart: `test_references.py` has them.
METHODS = [
    (name, one.name)
    for name, family in FAMILIES.items()
    for one in family.methods
    if name not in ("tolerance", "nine-points")
]
# They take seconds.
SEARCHES = {
    ("path-synthesis", "search"),
    ("function-synthesis", "minimax"),
}


def check(name, title, settings):
    for setting in settings:
        off = errors(name, found(name, title, setting))
        (most, missed) = next(v for (*k, s), v in KEPT.items() if k == [name, title] and (s == setting or np.isnan(s)))
        floor = 4 * FAMILIES[name].floor
        known = off[np.isfinite(off)]
        assert 1 - known.size / off.size == pytest.approx(missed, abs=0.02)
        if known.size:
            assert most / 3 - floor <= known.max() <= 3 * most + floor, (setting, known.max(), most)


@pytest.mark.parametrize(
    ("name", "title"), by_default([m for m in METHODS if not method(*m).slow and m not in SEARCHES], slice(0, None, 3))
)
def test_error_at_one_setting_is_the_kept_one(name, title):
    every = method(name, title).settings
    check(name, title, every[len(every) // 3 : len(every) // 3 + 1] or (np.nan,))


@pytest.mark.campaign
@pytest.mark.parametrize(("name", "title"), METHODS)
def test_errors_at_all_settings_are_the_kept_ones(name, title):
    check(name, title, method(name, title).settings or (np.nan,))


def test_every_family_and_method_is_kept_and_one_is_the_default():
    assert {(name, title) for name, title, _ in KEPT} == set(METHODS)
    for family in FAMILIES.values():
        assert sum(m.is_default for m in family.methods) == 1 and all(m.about.endswith(".") for m in family.methods)


@pytest.mark.parametrize(
    "name",
    ["four-bar-position", "four-bar-toggle", "four-bar-rates", "four-bar-toggle-rates", "new-lengths", "derivatives",
     "velocity-from-positions", "acceleration-from-positions", "positions-from-velocities", "slider-crank-position",
     "six-bar-position", "iteration", "cam-profile", "gear-root", "conjugate-tooth"],
)  # fmt: skip
def test_the_exact_methods_of_the_library_err_by_rounding_alone(name):
    (default,) = [m.name for m in FAMILIES[name].methods if m.is_default]
    assert errors(name, found(name, default)).max() <= 5 * FAMILIES[name].floor


@pytest.mark.parametrize(
    ("name", "title", "order", "coarse", "fine"),
    [
        *((f"{what}-from-positions", f"central differences, order {k}", k, 10.0, 5.0)
          for what in ("velocity", "acceleration") for k in (2, 4, 6)),
        ("velocity-from-positions", "velocity differences", 2, 10.0, 5.0),
        ("velocity-from-positions", "cubic spline", 4, 10.0, 5.0),
        ("acceleration-from-positions", "cubic spline", 2, 10.0, 5.0),
        ("positions-from-velocities", "mid-ordinates", 2, 10.0, 5.0),
        ("positions-from-velocities", "trapezoids", 2, 10.0, 5.0),
        ("positions-from-velocities", "Simpson's rule", 4, 10.0, 5.0),
        ("positions-from-velocities", "trapezoids with end correction", 4, 10.0, 5.0),
        ("derivatives", "central differences, order 2", 2, 1e-2, 1e-3),
        ("derivatives", "central differences, order 4", 4, 1e-1, 1e-2),
        ("derivatives", "central differences of geomkin.move", 2, 1e-2, 1e-3),
        ("four-bar-rates", "differences of positions", 4, 5.0, 1.0),
        ("tolerance", "differences", 2, 10.0, 1.0),
        *((name, "linear table", 2, 100, 1000) for name in ("four-bar-position", "six-bar-position")),
        *((name, "cubic table", 4, 100, 1000) for name in ("slider-crank-position", "six-bar-position")),
        ("cam-profile", "normals by differences", 4, 90, 360),
        ("cam-profile", "offset of the pitch polygon", 2, 45, 90),
    ],
)  # fmt: skip
def test_errors_fall_with_the_order_of_the_method(name, title, order, coarse, fine):
    """By a power of the step, or of its inverse, the number of entries or angles."""
    one, other = (np.nanmax(errors(name, found(name, title, setting))) for setting in (coarse, fine))
    assert np.log(one / other) / abs(np.log(coarse / fine)) == pytest.approx(order, abs=0.35 * order)


@pytest.mark.parametrize("name", ["four-bar-toggle", "four-bar-toggle-rates"])
def test_near_the_toggle_only_the_toggle_proof_form_keeps_its_digits(name):
    worst = {
        m.name: errors(name, found(name, m.name)).max()
        for m in FAMILIES[name].methods
        if not m.settings and m.name != "single precision"
    }
    kept_digits = {title for title, error in worst.items() if error < 2e-15}
    assert kept_digits == {"geomkin.move", "toggle-proof form, plain NumPy"}
    textbook = "unit vectors" if name == "four-bar-toggle" else "loop equations on unit vectors"
    assert worst[textbook] > (1e-13 if name == "four-bar-toggle" else 1e-9)


def test_newton_from_one_far_pose_fails_at_some_frames_alone():
    off = errors("iteration", found("iteration", "Newton, cold", 12.0))
    assert 0.5 < np.mean(off < 2e-14) < 1


# What is measured as an error, of results that are wrong by so much


def test_error_of_a_pose_is_that_of_the_worse_of_its_two_angles():
    bar, rocker = (z.copy() for z in problem("four-bar-position").right)
    bar[7] *= np.exp(1e-3j)
    bar[9] *= np.exp(-2e-3j)
    rocker[9] *= np.exp(5e-3j)
    rocker[11] = np.nan
    off = errors("four-bar-position", (bar, rocker))
    assert off[[7, 9]] == pytest.approx([1e-3, 5e-3], rel=1e-5) and np.isnan(off[11]) and len(off) == 360
    assert np.flatnonzero(off != 0).tolist() == [7, 9, 11]


def test_error_of_rates_is_that_of_the_worst_of_the_four_as_its_share():
    """As a share of 1 if the value is smaller; a value that is off by more than itself was not found."""
    given = problem("four-bar-toggle-rates")
    right = [*given.first, *given.second]
    sizes = np.abs(np.stack(right))
    for which in range(4):
        small, large = int(np.argmax(sizes[which] < 0.5)), int(np.argmax(sizes[which]))
        results = [rate.copy() for rate in right]
        results[which][small] += 0.25
        # A smaller error of another rate of the same pose does not show.
        results[(which + 1) % 4][small] -= 0.125
        wrong = {small: 0.25}
        if which >= 2:
            results[which][large] *= 1.75
            wrong[large] = 0.75
        off = errors("four-bar-toggle-rates", tuple(results))
        assert {k: off[k] for k in np.flatnonzero(off != 0)} == pytest.approx(wrong)
        for much in (1.01, np.inf, np.nan):
            results[which][small] = right[which][small] + much
            assert np.isnan(errors("four-bar-toggle-rates", tuple(results))[small])


@pytest.mark.parametrize("step", [0.5, 10.0])
@pytest.mark.parametrize(
    "name", ["velocity-from-positions", "acceleration-from-positions", "positions-from-velocities"]
)
def test_errors_of_samples_are_those_at_whole_degrees(name, step):
    right = problem(name).right
    values = np.interp(np.arange(3600) * step % 360, np.arange(361), np.append(right, right[0]))
    size = 1.0 if name.startswith("positions") else np.abs(right).max()
    # At 20 deg, on a later turn, and between two whole degrees if steps are half ones.
    values[int(20 / step)] += 0.1
    values[-int(10 / step)] -= 0.2
    values[1] += 0.3
    off = errors(name, (values, step))
    assert sorted(off[off > 1e-12].tolist()) == pytest.approx(np.array([0.1, 0.2, *[0.3] * (step >= 1)]) / size)
    assert len(off) == (1800 if step < 1 else 3600)


def test_errors_of_lengths_are_shares_of_the_largest_value():
    given = problem("new-lengths").right
    results = np.repeat(given, 6, axis=2)
    results[2, :, 30] += np.array([1e-3, 4e-3, 2e-3]) * np.abs(given).max(axis=(0, 2))
    results[3, 0, 31] += 1  # between two frames with a reference
    off = errors("new-lengths", results)
    assert np.flatnonzero(off).tolist() == [2 * 60 + 5] and off.max() == pytest.approx(4e-3)
    assert FAMILIES["new-lengths"].count(None, results) == 3600
    given = problem("derivatives").right
    results = np.repeat(given, 6, axis=1)
    results[[1, 3], 12] += 1e-3 * np.abs(given).max(axis=1)[[1, 3]] * np.array([1, 2j])
    off = errors("derivatives", results)
    assert np.flatnonzero(off).tolist() == [62, 182] and off[[62, 182]] == pytest.approx([1e-3, 2e-3])
