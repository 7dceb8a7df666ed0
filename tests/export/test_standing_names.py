"""Where names stand in stills: on their bodies, off holes, pins, paths and each other, by brute force."""

import numpy as np
import pytest
import shapely

import geomkin as gk
from geomkin.export.labels import half_size, place_labels, within
from geomkin.export.still import Still
from geomkin.model.scene import SceneBody, SceneMark
from tests.export.test_film import ALONG, FRAMES, scene_of

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


@pytest.mark.parametrize("turn", [0.0, 0.7, 2.0])
@pytest.mark.parametrize("shape", SHAPES)
def test_a_name_stands_on_its_plate_and_in_no_hole(shape, turn):
    one = body("name", *SHAPES[shape], at=210 + 90j, turn=np.exp(1j * turn))
    name = names_of(bodies=[one])["name"]
    ends = name.place + 0.9 * name.half.real * np.array([-1, 0, 1])
    plate = standing(one)
    on = [plate.distance(shapely.Point(z.real, z.imag)) < 0.05 for z in ends]
    # A bar that goes up is narrower than the name is long.
    assert on[1] and (all(on) or turn == 2.0)


def test_within_is_what_a_library_finds():
    rng = np.random.default_rng(5)
    for _ in range(20):
        polygon = rng.normal(size=7) + 1j * rng.normal(size=7)
        polygon = polygon[np.argsort(np.angle(polygon - polygon.mean()))]
        places = 2 * (rng.normal(size=50) + 1j * rng.normal(size=50))
        found = shapely.contains_xy(
            shapely.Polygon(np.column_stack([polygon.real, polygon.imag])), places.real, places.imag
        )
        assert within(polygon, places).tolist() == found.tolist()


@pytest.mark.parametrize("layer", [0, 1, 2])
@pytest.mark.parametrize("end", [-1, 1])
def test_a_name_keeps_from_below_plates_that_lie_over_its_own(layer, end):
    """A plate over more than half of a bar."""
    own = body("name", part(BAR), at=210 + 40j, layer=1)
    cover = body(
        "cover", part([-70 - 30j, 70 - 30j, 70 + 30j, -70 + 30j]), at=210 + 40j - 45 * end, layer=layer, named=False
    )
    name = names_of(bodies=[own, cover])["name"]
    if layer >= 1:
        ends = name.place + 0.89 * name.half.real * np.array([-1, 0, 1])
        assert not any(standing(cover).intersects(shapely.Point(z.real, z.imag)) for z in ends)
    else:
        # Nothing hides it there.
        assert name.place == pytest.approx(210 + 40j)
    gone = SceneBody("gone", cover.parts, ONE * np.nan, ONE, layer=layer, named=False)
    assert names_of(bodies=[own, gone])["name"].place == pytest.approx(210 + 40j)


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


def test_a_block_that_nothing_is_cut_of_is_named_beside_it():
    slide = SceneMark("slide", ONE * (200 + 50j), "construction", "way", direction=ONE)
    rod = body("long_rod", at=205 + 50j)
    found = names_of(slide, bodies=[rod])["long rod"]
    assert found.place == pytest.approx(200 + 50j - 1.6j * TALL)
    assert found.half == pytest.approx(complex(8 * 0.52 * TALL, TALL) / 2)
    # Of two the nearer, and none that is far off, or that stands still, or that is drawn as a line.
    other = SceneMark("slide", ONE * (240 + 50j), "construction", "other", direction=ONE)
    for marks in ((slide, other), (other, slide)):
        assert names_of(*marks, bodies=[rod])["long rod"].place.real == 200
    assert not names_of(slide, bodies=[body("rod", at=350 + 50j)])
    assert names_of(slide, bodies=[body("rod", at=320 + 50j)])
    assert not names_of(slide, bodies=[body("rod", at=205 + 50j, fixed=True)])
    line = SceneMark("line", ONE * 20, "construction", "long_rod", vector=ONE * 60j)
    assert names_of(slide, line, bodies=[rod])["long rod"].place.real != 200
    assert not names_of(slide, bodies=[body("rod", at=205 + 50j, named=False)])


def test_lines_are_named_at_their_middle_and_points_beside_them():
    line = SceneMark("line", ONE * (100 + 20j), "construction", "the_link", vector=ONE * (80 + 60j))
    touch = SceneMark("line", ONE * (100 + 20j), "contact", "touch", vector=ONE * (80 + 60j))
    point = SceneMark("point", ONE * (300 + 50j), "wanted", "tip_of_it")
    # Of lines by one name the first has it.
    again = SceneMark("line", ONE * (10 + 20j), "traced", "the_link", vector=ONE * 10)
    found = names_of(line, touch, again, point)
    assert set(found) == {"the link", "tip of it"}
    assert found["the link"].place == pytest.approx(140 + 50j) and found["the link"].role == "construction"
    half = half_size("tip of it", TALL)
    assert found["tip of it"].place == pytest.approx(300 + 50j + half + 0.75 * TALL * np.exp(0.25j * np.pi))
    assert found["tip of it"].role == "wanted" and found["tip of it"].half == pytest.approx(half)
    # Each next to the point on a side of its own, until there is none.
    crowd = [SceneMark("point", ONE * (200 + 50j), "wanted", f"no. {k}") for k in range(30)]
    around = names_of(*crowd)
    assert 6 <= len(around) < 30
    boxes = [box(name) for name in around.values()]
    dot = shapely.Point(200, 50)
    for k, one in enumerate(boxes):
        assert not one.covers(dot) and one.distance(dot) < 3 * TALL
        assert not any(one.intersection(other).area > 1e-6 for other in boxes[:k])
    place = ONE * (300 + 50j)
    place[0] = np.nan
    gone = [
        SceneMark("point", place, "wanted", "tip"),
        SceneMark("line", place, "traced", "side", vector=ONE),
        SceneMark("line", ONE, "traced", "other", vector=place),
    ]
    still = Still(scene_of(*FRAME, *gone), np.array([0, 1]))
    assert place_labels(still) == ()


SIDES = [45, 135, -45, -135, 0, 180, 90, -90]


@pytest.mark.parametrize("taken", range(2 * len(SIDES)))
def test_a_point_s_name_takes_the_first_of_its_sides_that_is_free(taken):
    """Each side that comes before is taken by a pin in the middle of where the name would be."""
    dot = 210 + 90j
    point = SceneMark("point", ONE * dot, "wanted", "a")
    pins, near = [], []
    for _ in range(taken + 1):
        near.append(names_of(point, *pins)["a"])
        pins.append(SceneMark("pin", ONE * near[-1].place, "construction", ""))
    assert len({complex(np.round(name.place, 3)) for name in near}) == taken + 1
    name, side = near[-1], np.exp(1j * np.radians(SIDES[taken % len(SIDES)]))
    assert box(name).distance(shapely.Point(210, 90)) > 0.7 * TALL
    if taken < len(SIDES):
        # From the corner or the middle of the side that is nearest it is in that direction, as far as three quarters of
        # a letter's height.
        corner = name.place - complex(
            np.sign(round(side.real, 9)) * name.half.real, np.sign(round(side.imag, 9)) * name.half.imag
        )
        assert corner - dot == pytest.approx(0.75 * TALL * side)
    else:
        # Farther off, on the same side of the point.
        inner = near[taken - len(SIDES)]
        assert abs(name.place - dot) > abs(inner.place - dot) + 0.8 * TALL
        assert abs(np.angle((name.place - dot) / (inner.place - dot))) < 0.3


def test_a_block_s_name_is_below_or_above_it_then_beside_it_then_farther_off():
    slide, rod = SceneMark("slide", ONE * (200 + 90j), "construction", "way", direction=ONE), body("rod", at=200 + 90j)
    pins, places = [], []
    for _ in range(6):
        places.append(names_of(slide, *pins, bodies=[rod])["rod"].place - (200 + 90j))
        pins.append(SceneMark("pin", ONE * (places[-1] + 200 + 90j), "construction", ""))
    aside = half_size("rod", TALL).real + 1.2 * TALL
    assert places == pytest.approx([-1.6j * TALL, 1.6j * TALL, aside, -aside, -2.8j * TALL, 2.8j * TALL])


def test_a_line_s_name_moves_along_it_and_then_aside():
    line = SceneMark("line", ONE * (10 + 90j), "construction", "ab", vector=ONE * 400)
    pins, places = [], []
    for _ in range(25):
        places.append(names_of(line, *pins)["ab"].place)
        pins.append(SceneMark("pin", ONE * places[-1], "construction", ""))
    along, beside = np.real(places) - 10, np.imag(places) - 90
    aside = half_size("ab", TALL).real + 0.5 * TALL
    assert along[:3] == pytest.approx([200, 140, 260]) and (beside[:3] == 0).all()
    wanted = [
        400 * share + step
        for step in (0, aside, -aside, 1.7j * TALL, -1.7j * TALL)
        for share in (0.5, 0.35, 0.65, 0.2, 0.8)
    ]
    assert np.sort_complex(np.round(along + 1j * beside, 6)) == pytest.approx(np.sort_complex(np.round(wanted, 6)))


def test_letters_that_fill_a_square_are_twice_as_wide():
    assert half_size("ab", 10.0) == pytest.approx(5.2 + 5j)
    assert half_size("a\u6f22\uff21", 10.0) == pytest.approx(12.6 + 5j)
    assert half_size("", 10.0) == 5j
