"""What stands still under a mechanism: bases whose holes are at the axes, plates of motors under all that turns."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.plane import Circle
from tests.gallery import RECIPES, marks, named, recipe

PLATE = gk.plane.Polyline(np.array([-200 - 200j, 200 - 200j, 200 + 200j, -200 + 200j]))


def plate(*holes, body="ground"):
    return gk.Part("base", PLATE, tuple(Circle(z, 1.0) for z in holes), 3.0, body=body)


WITH_BASE = ["planetary", "rack-and-pinion", "rocker-cam", "straight-sided"]


@pytest.mark.parametrize("name", WITH_BASE)
def test_every_axis_that_stands_still_stands_in_a_hole_of_the_base(name):
    text = (RECIPES / f"{name}.toml").read_text("utf-8")
    own = recipe(name) if "[base]" in text else gk.load(f"{text}\n[base]\n")
    body = named(own.scene, "ground")
    assert body.fixed and np.ptp(body.direction) == 0 and (body.origin == 0).all()
    (base,) = body.parts
    holes = [complex(hole.centre * body.direction[0]) for hole in base.holes if isinstance(hole, Circle)]
    axes = marks(own.scene, "fixed pin")
    assert axes and all((mark.place == mark.place[0]).all() for mark in axes)
    for mark in axes:
        assert min(abs(hole - mark.place[0]) for hole in holes) < 1e-9, mark.label
    assert all(other.layer > body.layer for other in own.scene.bodies if not other.fixed)


LAYERS = {
    "roller-cam": {"cam": 1, "roller": 1, "follower": 0},
    "rocker-cam": {"cam": 1, "roller": 1, "arm": 0},
    "flat-cam": {"cam": 1, "follower": 1},
    "flat-rocker-cam": {"cam": 1, "arm": 1},
}


@pytest.mark.parametrize(("name", "based"), list(zip(LAYERS, (True, False, True, False))))
def test_roller_arm_is_next_to_its_roller_and_above_the_base(name, based):
    """A face touches the cam itself, and so lies in its plane."""
    own = recipe(name)
    bodies = [*LAYERS[name], *["ground"] * based]
    parts = [plate(body=body) for body in bodies]
    scene = gk.cam.cam_scene(own.cam, own.table, parts)
    over = based and "roller" in LAYERS[name]
    wanted = {body: layer + over for body, layer in LAYERS[name].items()} | ({"ground": 0} if based else {})
    assert {body.name: body.layer for body in scene.bodies} == wanted
    assert [body.name for body in scene.bodies if body.fixed] == ["ground"] * based
    assert all(body.parts[0].body == body.name for body in scene.bodies)
