"""Masses of bodies: the sum of two is that of both together."""

import numpy as np
import pytest

import geomkin as gk


def test_sum_is_that_of_the_points_of_both():
    """Four point masses, grouped in two ways, against the sums over all of them."""
    masses, places = np.array([0.2, 0.5, 0.3, 1.1]), np.array([3 + 4j, -2j, 10 + 0j, -5 + 1j])
    points = [gk.Mass(m, z) for m, z in zip(masses, places)]
    centre = (masses * places).sum() / masses.sum()
    inertia = (masses * abs(places - centre) ** 2).sum()
    for total in (points[0] + points[1] + points[2] + points[3], (points[0] + points[2]) + (points[3] + points[1])):
        assert total.mass == pytest.approx(2.1, rel=1e-15)
        assert total.centre == pytest.approx(centre, rel=1e-14)
        assert total.inertia == pytest.approx(inertia, rel=1e-14)


def test_bodies_without_mass_add_nothing():
    total = gk.Mass(0.0) + gk.Mass(0.0, 5 + 1j)
    assert (total.mass, total.inertia) == (0, 0)
    assert (gk.Mass(0.0, 100 + 0j) + gk.Mass(2.0, 7j, 3.0)) == gk.Mass(2.0, 7j, 3.0)


@pytest.mark.parametrize("values", [{"mass": -1.0}, {"mass": 1.0, "inertia": -2.0}, {"mass": np.nan}])
def test_negative_masses_are_refused(values):
    with pytest.raises(gk.DesignError):
        gk.Mass(**values)
