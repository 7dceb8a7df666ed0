"""Cam and follower touch at every frame, also where undercut keeps the follower from where it should be."""

import numpy as np
import pytest

from tests.gallery import frames, marks, named, point, recipe, seen

ROLLERS = ["rocker-cam", "undercut-cam"]
FACES = ["flat-cam", "flat-rocker-cam"]
# mm. What chords and the search for an undercut's corners leave.
NEAR = 1e-4


@pytest.mark.parametrize("name", ROLLERS)
def test_rollers_touch(name):
    scene, radius = recipe(name).scene, recipe(name).cam.follower.roller_radius
    (contact,) = marks(scene, "point", "contact")
    for frame in frames(scene, 73):
        cam, centre = seen(named(scene, "cam"), frame), point(named(scene, "roller").origin[frame])
        assert cam.distance(centre) == pytest.approx(radius, abs=NEAR)
        assert cam.exterior.distance(point(contact.place[frame])) < NEAR
        assert point(contact.place[frame]).distance(centre) == pytest.approx(radius, abs=1e-9 * radius)


@pytest.mark.parametrize("name", FACES)
def test_faces_touch(name):
    scene = recipe(name).scene
    (contact,) = marks(scene, "point", "contact")
    carrier = next(body for body in scene.bodies if body.name in ("arm", "follower"))
    for frame in frames(scene, 37):
        cam, face = seen(named(scene, "cam"), frame), seen(carrier, frame)
        assert cam.intersection(face).area < 1e-3 and cam.distance(face) < NEAR
        assert max(body.exterior.distance(point(contact.place[frame])) for body in (cam, face)) < NEAR
        # Tangent to it: the cam lies on one side of the face's line.
        normal = np.exp(1j * np.angle(marks(scene, "vector", "force")[0].vector[frame]))
        corners = np.array(cam.exterior.coords) @ [1, 1j] - contact.place[frame]
        assert np.real(np.conj(normal) * corners).max() < NEAR


def test_pressure_angle_is_drawn_between_force_and_velocity():
    for name in ("roller-cam", "rocker-cam", "flat-rocker-cam"):
        scene = recipe(name).scene
        (force,), (way,) = marks(scene, "vector", "force"), marks(scene, "line", "direction of motion")
        reported = np.abs(scene.table["pressure_angle"])
        np.testing.assert_allclose(np.abs(np.degrees(np.angle(force.vector / way.vector))), reported, atol=1e-3)


def test_programmed_follower_is_drawn_if_lift_is_lost():
    scene = recipe("undercut-cam").scene
    (wished,) = marks(scene, "circle")
    lost = scene.table["lost_lift"]
    assert np.array_equal(np.isfinite(wished.place), lost > 0) and (lost > 0).any()
    apart = np.abs(wished.place - named(scene, "roller").origin)
    np.testing.assert_allclose(apart[lost > 0], lost[lost > 0], rtol=1e-9)
    assert [curve.label for curve in scene.curves if curve.role == "wanted"] == ["profile without undercut"]


@pytest.mark.parametrize(("name", "steepest"), [("flat-cam", 30), ("flat-rocker-cam", 45)])
def test_faces_have_the_sharpest_edge_of_the_check_for_a_line(name, steepest):
    scene = recipe(name).scene
    lines = {plot.title: [(limit.value, limit.label) for limit in plot.limits] for plot in scene.plots}
    (sharpest,) = (check for check in recipe(name).design_checks if check.name == "least convex radius of the profile")
    ((line, label),) = lines["curvature of the profile"]
    assert line * sharpest.limit == pytest.approx(1) and label == "sharper edges wear"
    # What the check finds is the highest point under that line.
    assert np.nanmax(scene.table["profile_curvature"]) == pytest.approx(1 / sharpest.value, rel=1e-2)
    words = f"at most {steepest} deg"
    assert lines["pressure angle"] == [(steepest, words), (-steepest, words)]
    assert not lines.get("curvature of the pitch curve")
