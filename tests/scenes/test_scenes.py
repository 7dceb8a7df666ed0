"""Every recipe of the gallery has a scene: a row for each frame, and the very parts that are cut."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.gear.scene import pitches_in_contact

from .gallery import NAMES, named, recipe


@pytest.mark.parametrize("name", NAMES)
def test_a_scene_has_a_row_for_each_frame(name):
    scene = recipe(name).scene
    frames = len(scene.drive.values)
    assert frames > 50 and np.all(np.diff(scene.time) > 0) and np.all(np.diff(scene.drive.values) > 0)
    for body in scene.bodies:
        assert body.origin.shape == body.direction.shape == (frames,)
        np.testing.assert_allclose(np.abs(body.direction[scene.assembled]), 1, atol=1e-12)
    for mark in scene.marks:
        rows = [row for row in (mark.place, mark.vector, mark.direction, mark.radius) if row is not None]
        assert all(row.shape == (frames,) for row in rows)


@pytest.mark.parametrize("name", NAMES)
def test_bodies_hold_the_parts_that_are_cut(name):
    own = recipe(name)
    for scene in (own.scene, *own.scene.others.values()):
        names = [body.name for body in scene.bodies]
        assert len(set(names)) == len(names)
        held = [part for body in scene.bodies for part in body.parts]
        # What is turned over is drawn as it is seen then.
        cuts = {id(one) for cut in own.parts for one in (cut, cut.outline)}
        assert all(id(part) in cuts or id(getattr(part.outline, "curve", None)) in cuts for part in held)
        assert all(curve.body in ("", *names) for curve in scene.curves)
    held = {id(part) for body in own.scene.bodies for part in body.parts}
    # Spacers stand between the layers, out of sight.
    assert all(id(part) in held for part in own.parts if part.body and part.name != "spacer")


@pytest.mark.parametrize("name", NAMES)
def test_what_goes_round_comes_back(name):
    """Bodies that are no wheels stand at the last frame where they did at the first."""
    scene = recipe(name).scene
    wheels = {"first", "second", "pinion", "gear", "mate", "ring", "tool", "sun"}
    for body in scene.bodies if scene.cyclic else ():
        if body.name not in wheels and not body.name.startswith("planet"):
            assert abs(body.direction[-1] - body.direction[0]) < 1e-9
            assert abs(body.origin[-1] - body.origin[0]) < 1e-6


def test_the_other_assembly_mode_is_shown_on_the_same_drive():
    scene = recipe("crank-rocker").scene
    (other,) = scene.others.values()
    assert np.array_equal(other.drive.values, scene.drive.values) and other.assembled.all()

    def side(shown):
        crank, rocker = named(shown, "coupler").origin, named(shown, "rocker")
        return np.sign(np.imag(np.conj(rocker.origin - crank) * (rocker.direction)))

    assert np.all(side(scene) == -side(other))


def test_a_linkage_of_many_dyads_is_shown_as_it_is_alone():
    assert recipe("walking-leg").scene.others == {}


def test_what_moves_with_a_body_is_not_fixed():
    scene = recipe("shaking-force").scene
    weight, crank = named(scene, "counterweight"), named(scene, "crank")
    assert not weight.fixed and np.array_equal(weight.direction, crank.direction)
    assert named(scene, "ground").fixed
    # It turns below the ground, under all plates of the stack.
    layers = {body.name: body.layer for body in scene.bodies}
    assert layers["counterweight"] == layers["ground"] == 0 < layers["crank"] < layers["coupler"]


def test_plates_without_a_stack_lie_in_one_layer_and_those_of_one_in_its_layers():
    recipe = gk.load("""kind = "four-bar"
linkage = { ground = 30, crank = 100, coupler = 90, rocker = 70 }""")
    plain = gk.linkage.linkage_scene(recipe.motion, recipe.table, recipe.parts)
    assert {body.layer for body in plain.bodies} == {0} and len(plain.bodies) == 5
    assert {body.name: body.layer for body in recipe.scene.bodies} == recipe.stack.layers
    assert recipe.stack.layers["bridge"] == max(recipe.stack.layers.values()) > 1


def test_many_linkages_or_no_frames_are_refused():
    def scene(crank, drive):
        motion = gk.move(gk.FourBar(100, crank, 90, 70), drive)
        return gk.linkage.linkage_scene(motion, gk.Table((gk.Column("a", "", "a", np.zeros(len(drive))),)))

    with pytest.raises(gk.DesignError, match=r"motion: found \(2,\) linkages; give one at a time"):
        scene(np.array([30.0, 31.0]), np.linspace(0, 6, 5))
    with pytest.raises(gk.DesignError, match="no frames"):
        scene(30.0, np.zeros(0))


def test_pitches_in_contact_are_whole_ones_and_bear_rounding():
    """A contact ratio of 2 is two pitches, also when rounding makes it a hair more."""
    found = [pitches_in_contact(ratio) for ratio in (0.4, 1.0, 1.2, 2 - 1e-13, 2.0, 2 + 1e-13, 2 + 1e-9)]
    assert found == [1, 1, 2, 2, 2, 2, 3]
