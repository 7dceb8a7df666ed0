"""Families of tolerances and of nine points: the references agree with random linkages and with the published number."""

import numpy as np
import pytest

from geomkin.synthesis.path.nine_point_equations import cognates_of, rotations_of
from geomkin.tradeoff.families import FAMILIES
from geomkin.tradeoff.families.nine_points import KNOWN, POINTS, missed_share
from geomkin.tradeoff.families.tolerance import BEYOND

TOLERANCE, NINE = FAMILIES["tolerance"], FAMILIES["nine-points"]
PROBLEM = TOLERANCE.problem()


def found(family, problem, name, setting=np.nan):
    (method,) = [method for method in family.methods if method.name.startswith(name)]
    return method.make(problem, setting)()


def test_the_reference_of_tolerances_is_the_limit_of_random_linkages():
    """Within the scatter of a quantile of so many, and nearer with a hundred times as many."""
    slope = 2 * np.exp(-4.5) / np.sqrt(2 * np.pi)
    for linkages in (1000, 100_000):
        scatter = np.sqrt(BEYOND * (1 - BEYOND) / linkages) / slope / 3
        errors = TOLERANCE.error(PROBLEM, found(TOLERANCE, PROBLEM, "Monte Carlo", linkages)) / PROBLEM.right
        assert errors.max() < 5 * scatter and errors.mean() > 0.1 * scatter


@pytest.mark.parametrize(
    ("name", "setting", "least", "most"),
    [
        # The second derivatives that both leave out, of the order of tolerance squared over length squared.
        ("linearised", np.nan, 1e-9, 1e-7),
        ("differences", 0.1, 1e-9, 1e-7),
        ("differences", 10.0, 1e-6, 1e-4),
    ],
)
def test_linearised_deviations_are_near_the_reference(name, setting, least, most):
    assert least < TOLERANCE.error(PROBLEM, found(TOLERANCE, PROBLEM, name, setting)).max() < most


def test_cognates_count_once_and_wrong_linkages_not_at_all():
    rows = found(NINE, POINTS, "some of the paths", 150)
    (missed,) = missed_share(POINTS, rows)
    assert 0.8 < missed < 1 and round(KNOWN * (1 - missed)) == len(rows)
    size = np.sqrt(np.mean(np.abs(POINTS[1:] - POINTS[0]) ** 2))
    offsets = (POINTS - POINTS[0])[1:] / size
    target = np.broadcast_to(np.concatenate([offsets, np.conj(offsets)]), (len(rows), 16))
    places = (rows.view(complex) - POINTS[0]) / size
    dyads = np.stack([places, np.conj(places)], axis=2).reshape(-1, 8)
    pairs = cognates_of(np.concatenate([dyads, rotations_of(dyads, target)], axis=1), target)
    cognates = [(pair[:, 0:8:2] * size + POINTS[0]).copy().view(float) for pair in pairs]
    together = np.concatenate([rows, rows[:, [4, 5, 6, 7, 0, 1, 2, 3]], *cognates, rows * 1.001])
    assert missed_share(POINTS, together) == pytest.approx(missed)
    for cognate in cognates:
        assert missed_share(POINTS, cognate) == pytest.approx(missed)
    assert missed_share(POINTS, np.empty((0, 8))) == 1


@pytest.mark.campaign
def test_continuation_finds_all_and_other_searches_few():
    assert missed_share(POINTS, found(NINE, POINTS, "continuation")) == 0
    for name, setting in (("Newton", 3e3), ("path search", 1)):
        assert 0.5 < missed_share(POINTS, found(NINE, POINTS, name, setting)) <= 1
