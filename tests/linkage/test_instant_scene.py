"""Centrodes roll, inflection circles hold points without curvature, polygons end where the velocities do."""

import numpy as np
import pytest

from tests.gallery import marks, named, recipe


@pytest.mark.parametrize("name", ["centrodes", "rolling-ellipses"])
def test_the_moving_centrode_rolls_on_the_fixed_one(name):
    scene, own = recipe(name).scene, recipe(name)
    coupler, (touch,) = (
        named(scene, "coupler"),
        [m for m in marks(scene, "point", "instant centre") if m.role == "centrode"],
    )
    rolling = [curve for curve in scene.curves if curve.role == "centrode"]
    fixed = [curve.curve for curve in rolling if not curve.body]
    moving = [curve.curve for curve in rolling if curve.body == "coupler"]
    assert len(fixed) == len(moving) > 0
    drive, met = own.centrodes.motion.drive, 0
    for one, two in zip(fixed, moving):
        inside = np.flatnonzero((drive >= one.breaks[0]) & (drive <= one.breaks[-1]))[:: max(1, len(drive) // 40)]
        pose = coupler.origin[inside], coupler.direction[inside]
        place = one.point(drive[inside])
        np.testing.assert_allclose(pose[0] + pose[1] * two.point(drive[inside]), place, atol=1e-6)
        np.testing.assert_allclose(touch.place[inside], place, atol=1e-6)
        # No slip: both are run through at one velocity.
        np.testing.assert_allclose(pose[1] * two.velocity(drive[inside]), one.velocity(drive[inside]), rtol=1e-6)
        met += len(inside)
    assert met > 10


def test_pins_of_the_inflection_circle_go_straight():
    scene = recipe("inflection-circle").scene
    (circle,) = marks(scene, "circle", "inflection")
    pole = marks(scene, "point", "inflection pole")[0].place
    centre = marks(scene, "point", "instant centre of the coupler")[0].place
    near = np.isfinite(pole) & np.isfinite(centre)
    assert near.any()
    for place in (pole, centre):
        np.testing.assert_allclose(np.abs(place - circle.place)[near], circle.radius[near], rtol=1e-9)
    (bend,) = marks(scene, "line", "radius of curvature")
    reported, known = scene.table["path_curvature"], np.isfinite(bend.vector)
    np.testing.assert_allclose(np.abs(bend.vector[known]) * np.abs(reported[known]), 1, rtol=1e-9)


def test_the_construction_of_bobillier_is_drawn_from_lines_that_meet_and_angles_that_are_equal():
    scene, motion = recipe("inflection-circle").scene, recipe("inflection-circle").motion
    drawn = [mark for mark in scene.marks if mark.role == "bobillier"]
    *rays, coupler, frame, crossing, axis, tangent = drawn
    assert [m.label for m in (coupler, axis)] == ["line to the crossing", "collineation axis"] and len(rays) == 2
    centre = marks(scene, "point", "instant centre of the coupler")[0].place
    known = np.flatnonzero(np.isfinite(axis.vector))
    assert len(known) > 50
    at = {pin: motion.point(pin).position[known] for pin in motion.linkage.pins}
    meet, pole = crossing.place[known], centre[known]

    def off(line, *points):
        # How far points are from a line that is drawn.
        start, way = line.place[known], line.vector[known]
        return max(np.abs(np.imag((z - start) / way) * np.abs(way)).max() for z in points)

    for link, ray in zip(("crank", "rocker"), rays):
        assert off(ray, at[f"{link}_pivot"], at[f"{link}_pin"], pole) < 1e-6
    for part, line in (("pin", coupler), ("pivot", frame)):
        assert off(line, at[f"crank_{part}"], at[f"rocker_{part}"], meet) < 1e-6
    assert off(axis, pole, meet) < 1e-6
    # From the tangent to one ray it is as far as from the other ray to the axis; and the tangent is the circle's.
    cranks = (at["crank_pin"] - at["crank_pivot"]) * (at["rocker_pin"] - at["rocker_pivot"])
    turn = tangent.vector[known] * axis.vector[known] / cranks
    np.testing.assert_allclose(np.imag(turn / np.abs(turn)), 0, atol=1e-6)
    (other,) = (mark for mark in marks(scene, "line", "centrode tangent") if mark.role == "inflection")
    np.testing.assert_allclose(np.imag(tangent.vector[known] / other.vector[known]), 0, atol=1e-6)


def test_shaking_forces_are_drawn_at_one_scale():
    scene, own = recipe("shaking-force").scene, recipe("shaking-force")
    arrows = [mark for mark in marks(scene, "vector", "1 mm is") if mark.label.endswith(" N")]
    scales = [np.abs(a.vector).max() / own.table[f"force_{n}"].max() for a, n in zip(arrows, ("none", "given", "best"))]
    assert len(scales) == 3
    np.testing.assert_allclose(scales, scales[0])
    assert scene.plots[0].columns == ("force_none", "force_given", "force_best")
