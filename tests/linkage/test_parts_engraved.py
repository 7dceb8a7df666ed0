"""A linkage drawn on a plate: lines and circles looked for where a hand would draw them."""

from dataclasses import replace

import numpy as np
import pytest

import geomkin as gk
from geomkin.linkage.parts.stock import PlateStock, skeleton
from tests.texts import parse, template_of


def test_circles_are_drawn_where_pins_are_and_nowhere_else():
    motion = gk.move(gk.FourBar(100, 30, 90, 70, 40 + 25j), [0.7])
    marks = skeleton(motion, 0, PlateStock(pin_diameter=4))
    circles = [mark for mark in marks if isinstance(mark, gk.plane.Circle)]
    pins = [0, 30 * np.exp(0.7j), motion.point("rocker_pin").position[0], 100]
    assert {circle.radius for circle in circles} == {2}
    away = np.abs(np.array([circle.centre for circle in circles])[:, None] - pins)
    assert len(circles) == 4 and away.min(axis=0) == pytest.approx(np.zeros(4), abs=1e-12)
    # Lines end at the circles of the pins, and run to the coupler point.
    lines = [mark for mark in marks if isinstance(mark, gk.plane.Segment)]
    ends = np.concatenate([line.point(np.array([0.0, 1.0])) for line in lines])
    away = np.abs(ends[:, None] - np.array([*pins, motion.point("coupler_point").position[0]])).min(axis=1)
    assert len(lines) == 5 and away == pytest.approx(np.full(10, 2))


def test_the_centre_of_curvature_is_a_dot_with_a_line_to_the_point():
    """Found by the circle through three neighbouring points of the path."""
    recipe = parse(template_of("inflection-circle"))
    recipe = replace(recipe, linkage=replace(recipe.linkage, coupler_point=40 + 25j))
    (part,) = recipe.parts
    here = recipe.position.drive[0]
    a, b, c = gk.move(recipe.linkage, here + np.array([-1e-3, 0, 1e-3]), recipe.branch).point("coupler_point").position
    one, two = a - b, c - b
    away = one * two * np.conj(one - two) / (np.conj(one) * two - one * np.conj(two))
    centre, dot = b + away, recipe.stock.pin_diameter / 4
    near = [
        mark
        for mark in part.marks
        if isinstance(mark, gk.plane.Circle) and abs(mark.centre - centre) < 1e-3 * abs(away)
    ]
    assert [mark.radius for mark in near] == [dot]
    ends = [mark.point(np.array([0.0, 1.0])) for mark in part.marks if isinstance(mark, gk.plane.Segment)]
    assert any(abs(e[0] - centre) < 1e-3 * abs(away) and abs(e[1] - b) < 1e-9 for e in ends)


@pytest.mark.parametrize("scale", [0.004, 50])
def test_the_inflection_circle_of_a_linkage_of_any_size_is_drawn(scale):
    def marks(scale):
        bar = gk.FourBar(*(scale * z for z in (100, 30, 90, 70)), coupler_point=scale * (40 + 25j))
        recipe = parse(template_of("inflection-circle"))
        stock = replace(recipe.stock, pin_diameter=4 * scale)
        recipe = replace(recipe, linkage=bar, position_deg=15.0, stock=stock)
        return recipe.parts[0].marks, recipe.table["inflection_diameter"][15] / 2

    (plain, radius), (scaled, small) = marks(1), marks(scale)
    assert [type(mark) for mark in scaled] == [type(mark) for mark in plain] and small == pytest.approx(scale * radius)
    for one, other in zip(scaled, plain, strict=True):
        if isinstance(one, gk.plane.Circle | gk.plane.Arc | gk.plane.Segment):
            ends = [mark.point(mark.breaks[[0, -1]]) for mark in (one, other)]
            assert ends[0] == pytest.approx(scale * ends[1], abs=1e-9 * scale)
    # The circle itself, and at one end of its diameter the tangent, as long as the diameter, half to either side.
    (circle,) = (m for m in plain if isinstance(m, gk.plane.Circle) and m.radius == pytest.approx(radius))
    tangents = [
        mark
        for mark in plain
        if isinstance(mark, gk.plane.Segment)
        and abs((mark.start + mark.end) / 2 - circle.centre) == pytest.approx(radius)
        and abs(mark.end - mark.start) == pytest.approx(2 * radius)
    ]
    assert len(tangents) == 1
