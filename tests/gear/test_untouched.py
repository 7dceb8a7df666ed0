"""Why a stretch of a tooth touches nothing: held against where its normals meet the pitch circle."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.gear.conjugate.conjugate import BEYOND, TRIMMED

PIN, RADIUS, TEETH = gk.plane.Circle(46.6j, 1.3), 45.0, 30
MATE_TEETH, ADDENDUM = 20, 3.2


@pytest.fixture(scope="module")
def mate():
    """Of a pin that stands out of its pitch circle, so that each of its normals meets that circle in two places."""
    return gk.conjugate(PIN, TEETH, RADIUS, MATE_TEETH, ADDENDUM)


def distances(t):
    """From the mate's axis, of the two places where the pin's point at t would touch: on a line through the pitch point."""
    point, normal = complex(PIN.point(t)), complex(PIN.point(t) - PIN.centre) / PIN.radius
    foot = (np.conj(normal) * point).imag
    if abs(foot) >= RADIUS:
        return []
    ends = [normal * complex(s * np.sqrt(RADIUS**2 - foot**2), foot) for s in (-1, 1)]
    axis = RADIUS + RADIUS * MATE_TEETH / TEETH
    return [abs(point * RADIUS / end - axis) for end in ends]


def test_a_stretch_with_a_place_within_the_tips_is_not_called_beyond_them(mate):
    tip = RADIUS * MATE_TEETH / TEETH + ADDENDUM
    seen = set()
    for stretch in mate.untouched:
        t = stretch.start + (stretch.end - stretch.start) * np.array([0.1, 0.5, 0.9])
        beyond = np.array([[d > tip for d in distances(place)] for place in t])
        if stretch.why == BEYOND:
            # The other place is one where it would cut the mate.
            assert beyond.any(axis=1).all()
            seen.add("beyond")
        elif stretch.why == TRIMMED:
            assert not beyond.all(axis=1).any()
            seen.add("one of two beyond" if beyond.any() else "trimmed")
    assert {"beyond", "one of two beyond"} <= seen


def test_radii_of_a_stretch_are_the_least_and_largest_along_it(mate):
    assert mate.untouched
    for stretch in mate.untouched:
        along = np.abs(PIN.point(np.linspace(stretch.start, stretch.end, 2001)))
        assert stretch.inner_radius == pytest.approx(along.min(), rel=2e-4)
        assert stretch.outer_radius == pytest.approx(along.max(), rel=2e-4)
        assert stretch.inner_radius >= along.min() * (1 - 1e-12) and stretch.outer_radius <= along.max() * (1 + 1e-12)
