"""Every recipe of the gallery has a scene: a row for each frame, and the very parts that are cut."""

import numpy as np
import pytest

import geomkin as gk
from tests.gallery import named, recipe


def test_the_other_assembly_mode_is_shown_on_the_same_drive():
    scene = recipe("crank-rocker").scene
    (other,) = scene.others.values()
    assert np.array_equal(other.drive.values, scene.drive.values) and other.assembled.all()

    def side(shown):
        crank, rocker = named(shown, "coupler").origin, named(shown, "rocker")
        return np.sign(np.imag(np.conj(rocker.origin - crank) * (rocker.direction)))

    assert np.all(side(scene) == -side(other))


def test_marks_on_a_moving_body_are_not_fixed():
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
    assert {body.name: body.layer for body in recipe.scene.bodies} == recipe.made.stack.layers
    assert recipe.made.stack.layers["bridge"] == max(recipe.made.stack.layers.values()) > 1


def test_many_linkages_or_no_frames_are_refused():
    def scene(crank, drive):
        motion = gk.move(gk.FourBar(100, crank, 90, 70), drive)
        return gk.linkage.linkage_scene(motion, gk.Table((gk.Column("a", "", "a", np.zeros(len(drive))),)))

    with pytest.raises(gk.DesignError, match=r"motion:"):
        scene(np.array([30.0, 31.0]), np.linspace(0, 6, 5))
    with pytest.raises(gk.DesignError):
        scene(30.0, np.zeros(0))
