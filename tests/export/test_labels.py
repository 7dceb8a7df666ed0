"""Where names stand in stills: on their bodies, off holes, pins, paths and each other, by brute force."""

import numpy as np
import pytest
import shapely

import geomkin as gk
from geomkin.export.still import Still, place_labels
from geomkin.model.scene import SceneBody, SceneMark
from tests.export.test_animated_marks import ALONG, FRAMES, scene_of

ONE = np.ones(FRAMES, dtype=complex)
# Width of the scenes, mm: a pixel of the picture is a millimetre, and letters are 11 mm high.
WIDE, TALL = 420.0, 11.0


def part(outline, *holes, name="part"):
    corners = outline if hasattr(outline, "point") else gk.plane.Polyline(np.array(outline))
    return gk.Part(name, corners, tuple(gk.plane.Circle(*hole) for hole in holes), 3.0)


def body(name, *parts, at=0j, turn=1 + 0j, **more):
    return SceneBody(name, parts, ONE * at, ONE * turn, **more)


# What makes the scene as wide as it is, far from what is looked at.
FRAME = [SceneMark("pin", ONE * z, "construction", "") for z in (0j, WIDE + 0j)]


def names_of(*marks, bodies=(), frame=0):
    still = Still(scene_of(*FRAME, *marks, bodies=bodies), np.array([frame]))
    assert still.pixel == pytest.approx(1.0)
    return {name.text: name for name in place_labels(still)}


def box(name):
    low, high = name.place - name.half, name.place + name.half
    return shapely.box(low.real, low.imag, high.real, high.imag)


def standing(one):
    """A body's plates where they are, as one polygon."""

    def ring(curve):
        z = one.origin[0] + one.direction[0] * gk.flatten(curve, 0.01)
        return np.column_stack([z.real, z.imag])

    return shapely.union_all([shapely.Polygon(ring(p.outline), [ring(h) for h in p.holes]) for p in one.parts])


BAR = [-90 - 12j, 90 - 12j, 90 + 12j, -90 + 12j]
ELL = [0, 120, 120 + 26j, 26 + 26j, 26 + 120j, 120j]
SHAPES = {
    "a bar with a hole in its middle": (part(BAR, (0j, 9.0)),),
    "a ring": (part(gk.plane.Circle(0j, 60.0), (0j, 40.0)),),
    "an angle": (part(ELL),),
    "a bar and a disc beside it": (part(BAR), part(gk.plane.Circle(0 + 60j, 40.0), (60j, 20.0))),
    "a plate of four holes": (
        part([-50 - 50j, 50 - 50j, 50 + 50j, -50 + 50j], *((30 * 1j**k, 13.0) for k in range(4))),
    ),
}


@pytest.mark.parametrize("shape", SHAPES)
def test_a_name_stands_on_its_plate_and_in_no_hole(shape, turn=0.7):
    one = body("name", *SHAPES[shape], at=210 + 90j, turn=np.exp(1j * turn))
    name = names_of(bodies=[one])["name"]
    ends = name.place + 0.9 * name.half.real * np.array([-1, 0, 1])
    plate = standing(one)
    on = [plate.distance(shapely.Point(z.real, z.imag)) < 0.05 for z in ends]
    # A bar that goes up is narrower than the name is long.
    assert on[1] and (all(on) or turn == 2.0)


def test_a_name_keeps_off_pins_dots_stands_and_paths():
    own = body("name", part(BAR), at=210 + 40j)
    free = names_of(bodies=[own])["name"]
    assert free.place == pytest.approx(210 + 40j)
    at_origin = Still(scene_of(bodies=[body("name", part(BAR))]), np.array([0]))
    assert [name.place for name in place_labels(at_origin)] == pytest.approx([0])
    path = 210 + 40j + (0.5 * ALONG - 20) * 1j
    for mark in (
        SceneMark("pin", ONE * free.place, "construction", "pin"),
        SceneMark("slide", ONE * free.place, "construction", "block", direction=ONE),
        SceneMark("point", ONE * free.place, "construction", ""),
        # Where no plate shows the ground a stand is drawn below its pin.
        SceneMark("fixed pin", ONE * (free.place + 0.8j * TALL), "construction", "pin"),
    ):
        name = names_of(mark, bodies=[own])["name"]
        assert not box(name).covers(shapely.Point(free.place.real, free.place.imag)), mark.sort
    trail = SceneMark("point", path, "traced", "", trail=True)
    assert box(names_of(trail, bodies=[own])["name"]).distance(shapely.LineString([[z.real, z.imag] for z in path])) > 0
    # A pin counts as wide as the hole that it sits in.
    pins = [SceneMark("pin", ONE * (free.place + 12j), "construction", "pin")]
    wide = body("wide", part(gk.plane.Circle(0j, 12.0), (0j, 11.0)), at=free.place + 12j, named=False, layer=-1)
    small = body("wide", part(gk.plane.Circle(0j, 12.0), (0j, 3.0)), at=free.place + 12j, named=False, layer=-1)
    assert names_of(*pins, bodies=[own, small])["name"].place == pytest.approx(free.place)
    assert abs(names_of(*pins, bodies=[own, wide])["name"].place - free.place) > 1


def test_names_keep_off_each_other_and_one_without_room_is_left_out():
    bodies = [body(f"body {k}", part([-40 - 22j, 40 - 22j, 40 + 22j, -40 + 22j]), at=210 + 40j) for k in range(9)]
    named = names_of(bodies=bodies)
    boxes = [box(name) for name in named.values()]
    assert 2 <= len(boxes) < 9
    for k, one in enumerate(boxes):
        assert not any(one.intersects(other) for other in boxes[:k])
    # Those of the smaller bodies have the better places.
    small = body("small", part([-30 - 12j, 30 - 12j, 30 + 12j, -30 + 12j]), at=210 + 40j)
    large = body("large", part([-130 - 52j, 130 - 52j, 130 + 52j, -130 + 52j]), at=210 + 40j)
    for bodies in ([small, large], [large, small]):
        found = names_of(bodies=bodies)
        assert found["small"].place == pytest.approx(210 + 40j) != found["large"].place
