"""No result depends on the length of a direction, and what is not known is nan in both parts."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.linkage import (
    Centrodes,
    PathCurvature,
    bobillier,
    bobillier_path,
    crank_path,
    inflection_circle,
    inflection_circle_of_cranks,
    instant_centre,
    path_curvature,
)

FOUR_BAR = gk.FourBar(100, 30, 90, 70)
# It opens over part of the turn.
OPENS = [
    gk.FourBar(100, 80, 60, 50, ground_angle_deg=10),
    gk.SliderCrank(90, 60, coupler_point=3j),
    gk.InvertedSliderCrank(80, 30, 100.0),
]


@pytest.mark.parametrize("length", [1e-6, 7.0])
def test_distance_along_a_ray_is_that_of_the_circle(length: float) -> None:
    circle = inflection_circle(gk.move(FOUR_BAR, [0.4, 1.7, 4.0]), "coupler")
    direction = np.exp(1j * np.array([0.3, 2.0, 5.0]))
    distance = circle.inflection(length * direction)
    on_ray = circle.instant_centre.position + distance * direction
    middle = (circle.instant_centre.position + circle.pole) / 2
    np.testing.assert_allclose(abs(on_ray - middle), circle.diameter / 2, rtol=1e-12)


def test_paths_of_cranks_take_a_tangent_of_any_length() -> None:
    crank, slide = crank_path(30j, 0j), (100 + 20j, np.exp(0.2j))
    pairs = [(crank, PathCurvature(slide[0], length * slide[1], 0.0)) for length in (1.0, 5.0)]
    for quantity in ("diameter", "pole", "nearest"):
        one, five = (getattr(inflection_circle_of_cranks(*pair), quantity) for pair in pairs)
        np.testing.assert_allclose(five, one, rtol=1e-12)
    one, five = (bobillier(*pair) for pair in pairs)
    np.testing.assert_allclose(five.tangent_foot, one.tangent_foot, rtol=1e-12)
    bent = PathCurvature(1 + 2j, 3 + 4j, 0.1)
    np.testing.assert_allclose(bent.centre, 1 + 2j + 10j * (0.6 + 0.8j), rtol=1e-14)


def test_bobillier_path_takes_a_tangent_line_of_any_length() -> None:
    crank, foot = crank_path(30j, 0j), 80j
    # A line nearly along the crank: of a short direction it was taken for the crank's own line.
    for tangent in (np.exp(0.7j), 1j * np.exp(1e-6j)):
        curvatures = [bobillier_path(crank, foot, length * tangent, 60 + 40j).curvature for length in (1e-9, 1.0, 1e9)]
        np.testing.assert_allclose(curvatures, curvatures[1], rtol=1e-9)


@pytest.mark.parametrize("frames", [10])
@pytest.mark.parametrize("linkage", OPENS, ids=lambda one: type(one).__name__)
def test_open_is_nan_in_both_parts(linkage: gk.linkage.AbstractLinkage, frames: int) -> None:
    motion = gk.move(linkage, np.linspace(0, 2 * np.pi, frames), speed=2.0)
    assert not motion.assembled.all()
    for body in list(motion.bodies)[1:]:
        moved, circle = motion.bodies[body], inflection_circle(motion, body)
        centre, path = instant_centre(motion, body, motion.linkage.ground), path_curvature(motion, body, 3 + 4j)
        values = [moved.direction, centre.reference, centre.arm, path.position, path.tangent, path.centre]
        for point in (moved.origin, moved.point(3 + 4j)):
            values += [point.position, point.first, point.second, point.velocity, point.acceleration]
        values += [circle.reference, circle.velocity, circle.acceleration, circle.pole, circle.centre_velocity]
        values += [Centrodes(motion, body).fixed, Centrodes(motion, body).moving]
        for value in values:
            np.testing.assert_array_equal(np.isnan(value.real), np.isnan(value.imag))
            assert np.isnan(value[~motion.assembled]).all()
