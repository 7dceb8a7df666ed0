"""Centrodes roll, inflection circles hold points without curvature, polygons end where the velocities do."""

import numpy as np
import pytest

from geomkin.linkage.instant.curvature import path_curvature
from geomkin.linkage.instant.inflection import inflection_circle
from geomkin.linkage.instant.polygons import velocity_polygon
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
    told, known = scene.table["path_curvature"], np.isfinite(bend.vector)
    np.testing.assert_allclose(np.abs(bend.vector[known]) * np.abs(told[known]), 1, rtol=1e-9)


def test_what_is_farther_than_three_sizes_is_left_out_and_bends_farther_than_one():
    own = recipe("inflection-circle")
    scene, size = own.scene, float(np.max(own.linkage.linkage.size))
    circle = inflection_circle(own.motion, "coupler")
    path = path_curvature(own.motion, "coupler", own.linkage.coupler_point)
    for sort, label, place, far in (
        ("point", "instant centre of the coupler", circle.instant_centre.position, 3 * size),
        ("point", "inflection pole", circle.pole, 3 * size),
        ("point", "centre of curvature", path.centre, size),
    ):
        (mark,) = marks(scene, sort, label)
        with np.errstate(invalid="ignore"):
            near = np.abs(place - path.position) < far
        assert 0 < near.sum() < len(near) and np.array_equal(np.isfinite(mark.place), near)
        assert np.abs(mark.place - place)[near].max() < 1e-9
    tangent, normal = marks(scene, "line", "centrode tangent")[0], marks(scene, "line", "centrode normal")[0]
    seen = np.isfinite(tangent.vector) & np.isfinite(normal.vector)
    assert np.abs(tangent.vector[seen]) == pytest.approx(1.5 * size) and seen.any()
    assert (tangent.place + tangent.vector / 2)[seen] == pytest.approx(normal.place[seen])
    across = np.real(tangent.vector * np.conj(normal.vector))[seen]
    assert np.abs(across).max() < 1e-6 * size**2
    # In plots, too: lengths that run off are gaps, and rates and angles are as they are.
    for column in scene.table.columns:
        values = np.asarray(own.table[column.header])
        kept = np.abs(values) < 3 * size if column.unit == "mm" else np.isfinite(values)
        assert np.array_equal(np.isfinite(column.values), kept & np.isfinite(values)), column.header


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


def test_polygons_start_at_the_position_asked_for_and_are_those_that_are_cut():
    scene, own = recipe("polygons").scene, recipe("polygons")
    assert scene.drive.values[0] == pytest.approx(own.position) and scene.cyclic
    cut = velocity_polygon(own.motion)
    sides = {
        mark.label.split(",")[0]: mark for mark in marks(scene, "vector", "1 mm is") if mark.label.startswith("v ")
    }
    absolute = [v for v in cut.vectors if v.kind == "absolute"]
    ratios = [sides[f"v {v.end}"].vector[0] / v.tip for v in absolute]
    assert len(ratios) > 1
    np.testing.assert_allclose(ratios, ratios[0], rtol=1e-9)
    # One pole for all.
    assert np.ptp([sides[f"v {v.end}"].place[0].real for v in absolute]) < 1e-9


def test_curves_of_an_atlas_are_those_of_its_table():
    scene, own = recipe("coupler-atlas").scene, recipe("coupler-atlas")
    traced = {mark.label: mark for mark in marks(scene, "point", "r") if mark.trail and mark.label[1:2].isdigit()}
    assert len(traced) == own.grid.rows * own.grid.columns
    place = traced["r2c1"].place
    np.testing.assert_array_equal(place, own.table["r2c1_x"] + 1j * own.table["r2c1_y"])


def test_shaking_forces_are_drawn_at_one_scale():
    scene, own = recipe("shaking-force").scene, recipe("shaking-force")
    arrows = [mark for mark in marks(scene, "vector", "1 mm is") if mark.label.endswith(" N")]
    scales = [np.abs(a.vector).max() / own.table[f"force_{n}"].max() for a, n in zip(arrows, ("none", "given", "best"))]
    assert len(scales) == 3
    np.testing.assert_allclose(scales, scales[0])
    assert scene.plots[0].columns == ("force_none_N", "force_given_N", "force_best_N")
