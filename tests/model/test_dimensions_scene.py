"""Dimensions in scenes: each is drawn as long as its words say, where what it measures is."""

import re

import numpy as np
import pytest

import geomkin as gk
from geomkin.linkage.scene import link_dimensions
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
        (told,) = re.findall(r"(\S+) mm", label)
        assert float(told) == pytest.approx(abs(end - start), rel=1e-4), label


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


def test_diameters_of_gears_go_through_their_axes():
    own = recipe("gear-pair")
    first, second = own.design.first, own.design.second
    found = dimensions(own.scene)
    away = own.design.centre_distance
    for name, gear, centre in (("first", first, 0), ("second", second, away)):
        for circle, radius in (("tip", gear.tip_radius), ("pitch", gear.pitch_radius), ("root", gear.root_radius)):
            (curve,) = [c for label, c in found.items() if label.endswith(f"{circle} circle of the {name}")]
            start, end = ends(curve)
            assert abs(end - start) == pytest.approx(2 * radius)
            middle = (start + end) / 2
            assert abs(middle) == pytest.approx(centre, abs=1e-9)
    (between,) = [c for label, c in found.items() if label.startswith("centre distance")]
    assert ends(between)[0] == 0 and abs(ends(between)[1]) == pytest.approx(away)
    # No two diameters lie on each other.
    ways = [np.angle((e - s) ** 2) for s, e in map(ends, found.values())]
    assert np.abs(np.subtract.outer(ways[:3], ways[:3]) + 9 * np.eye(3)).min() > 0.2


SIX = gk.Linkage(
    {
        "ground": {"O": 0, "C": 100},
        "crank": {"O": 0, "A": 30},
        "plate": {"A": 0, "B": 90, "D": 40 + 30j, "E": 60 + 40j, "tip": 10j},
        "rocker": {"C": 0, "B": 70},
        "one": {"D": 0, "F": 40},
        "two": {"E": 0, "F": 45},
    },
    "crank",
)


def test_of_many_joints_those_to_the_next_are_told_and_of_few_all():
    found = [(curve.body, curve.label) for curve in link_dimensions(SIX)]
    assert [label.split(", ")[1] for body, label in found if body == "plate"] == ["A to B", "B to D", "D to E"]
    assert sorted(label for body, label in found if body != "plate") == [
        "100 mm, O to C", "30 mm, O to A", "40 mm, D to F", "45 mm, E to F", "70 mm, C to B",
    ]  # fmt: skip
    straight, rod = (gk.move(gk.SliderCrank(30, 90, offset=by), [0.4]).linkage for by in (0, 8))
    told = {curve.label: curve for curve in link_dimensions(rod)}
    (offset,) = [label for label in told if label.startswith("offset")]
    start, end = ends(told[offset])
    # Square to the line on which the slider goes, from the first joint of what it goes along.
    (slider,) = rod.sliders
    assert abs(end - start) == pytest.approx(8) and told[offset].body == slider.along
    assert abs(np.imag((end - complex(slider.through)) / complex(slider.direction))) < 1e-9
    assert not [label for label in (c.label for c in link_dimensions(straight)) if "offset" in label]
