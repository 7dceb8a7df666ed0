"""Dimensions in scenes: each is drawn as long as its words say, where what it measures is."""

import re

import numpy as np
import pytest

from tests.gallery import named, recipe

NAMES = [
    *("walking-leg", "shaper", "rocker-cam", "gear-pair", "planetary", "rack-and-pinion", "ring-gear", "lantern"),
]


def ends(curve):
    return tuple(complex(z) for z in curve.curve.point(np.asarray(curve.curve.breaks)))


def dimensions(scene):
    return {curve.label: curve for curve in scene.curves if curve.role == "dimension"}


@pytest.mark.parametrize("name", NAMES)
def test_a_dimension_is_as_long_as_it_says(name):
    scene = recipe(name).scene
    found = dimensions(scene)
    assert found
    for label, curve in found.items():
        start, end = ends(curve)
        (reported,) = re.findall(r"(\S+) mm", label)
        assert float(reported) == pytest.approx(abs(end - start), rel=1e-4), label


@pytest.mark.parametrize("name", ["roller-cam", "rocker-cam", "flat-cam", "flat-rocker-cam"])
def test_those_of_a_follower_begin_and_end_where_it_is(name):
    own = recipe(name)
    scene, follower = own.scene, own.cam.follower
    found = {label.split(" mm")[0].rsplit(" ", 1)[0]: curve for label, curve in dimensions(scene).items()}
    assert "base radius" in found and ends(found["base radius"])[0] == 0
    declared = {"pivot distance", "offset", "arm length", "roller radius"}
    declared = {what for what in declared if getattr(follower, what.replace(" ", "_"), 0)}
    assert set(found) == declared | {"base radius"}
    pins = {mark.label: mark.place[0] for mark in scene.marks if mark.sort.endswith("pin")}
    for what in declared:
        start, end = ends(found[what])
        body = named(scene, found[what].body) if found[what].body else None
        if body:
            start, end = (complex(body.origin[0] + body.direction[0] * z) for z in (start, end))
        if what == "pivot distance":
            assert (start, end) == pytest.approx((0, pins["pivot"]))
        elif what == "offset":
            # Square to the follower's way, to the line in which it goes.
            (way,) = [mark for mark in scene.marks if mark.label == "direction of motion"]
            assert start == 0 and abs(np.real(end / way.vector[0])) < 1e-9
        elif what == "arm length":
            assert start == pytest.approx(pins["pivot"]) and abs(end - pins.get("roller", end)) < 1e-6
        else:
            assert start == pytest.approx(pins["roller"])
