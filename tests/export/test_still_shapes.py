"""Stills of scenes made by hand, read back: how large pins, blocks and arrows are, and what is drawn where."""

import io
import re

import ezdxf
import numpy as np
import pytest

import geomkin as gk
from geomkin.export.dxf import assembly_drawing
from geomkin.export.job import Job, StaticSource
from geomkin.export.scene_svg import assembly_picture
from geomkin.export.still import Still, place_labels
from geomkin.model.scene import SceneBody, SceneCurve, SceneMark
from tests.export.stills import SPACE, loops, placed, root_of, titled
from tests.export.test_animated_marks import FRAMES, scene_of

ONE = np.ones(FRAMES, dtype=complex)


def plate(*holes, name="plate", wide=420.0, high=200.0, marks=()):
    """As wide as what is called a pixel 420 times, where it is the largest thing shown."""
    corners = np.array([0, wide, complex(wide, high), 1j * high])
    return gk.Part(name, gk.plane.Polyline(corners), tuple(gk.plane.Circle(*hole) for hole in holes), 3.0, marks=marks)


def body(part, name="plate", at=0j, turn=1 + 0j, **more):
    return SceneBody(name, (part,) if part else (), ONE * at, ONE * turn, **more)


def still_of(*marks, at=0.0, **more):
    scene = scene_of(*marks, **more)
    return root_of(assembly_picture(Job("still", StaticSource((), scene.table, scene), 0.01, assembly_at=at)))


def pin(place, label, sort="pin"):
    return SceneMark(sort, ONE * place, "construction", label)


def drawn(root, name):
    """The shapes of what has this title, without the title."""
    return [one for one in titled(root, name) if one.tag != f"{SPACE}title"]


def numbers(text):
    return [float(one) for one in re.findall(r"-?\d*\.?\d+", text)]


@pytest.mark.parametrize(("k", "grounded"), [(1.0, False), (2.5, True)])
def test_a_pin_fills_the_widest_hole_that_it_sits_in_and_stands_on_the_ground_where_no_plate_shows_it(k, grounded):
    turn, at = np.exp(0.5j), k * (30 - 10j)
    holes = [(k * (100 + 100j), 5.0 * k), (k * (300 + 100j), 20.0 * k), (k * (200 + 50j), 1.0 * k)]
    here = {name: at + turn * place for name, (place, _) in zip(("fits", "wide", "narrow"), holes)}
    here |= {"other": here["fits"] + 11 * k, "alone": at + turn * k * (50 + 20j)}
    long = gk.Part(
        "long",
        gk.plane.Polyline(k * np.array([0, 420, 420 + 200j, 200j])),
        tuple(gk.plane.Circle(*h) for h in holes),
        3.0,
    )
    second = gk.Part("second", gk.plane.Circle(0j, 12.0 * k), (gk.plane.Circle(0j, 6.0 * k),), 3.0)
    bodies = [body(long, "long", at, turn), body(second, "second", here["fits"], fixed=grounded)]
    corners = at + turn * k * np.array([0, 420, 420 + 200j, 200j])
    px = max(np.ptp(corners.real), np.ptp(corners.imag)) / 420
    root = still_of(
        *(pin(z, name, "fixed pin" if name == "alone" else "pin") for name, z in here.items()), bodies=bodies
    )
    wanted = {"fits": 6 * k, "wide": 8 * px, "narrow": 3.2 * px, "other": 3.8 * px, "alone": 3.8 * px}
    for name, radius in wanted.items():
        *stands, circle = [one for one in drawn(root, name) if one.get("class") != "core"]
        assert float(circle.get("r")) == pytest.approx(radius, rel=5e-3), name
        assert circle.get("class") == "pin" and placed(titled(root, name).get("transform"))(0) == pytest.approx(
            here[name], abs=0.08
        )
        cores = [one for one in drawn(root, name) if one.get("class") == "core"]
        assert len(cores) == (name == "alone") and len(stands) == (name == "alone" and not grounded)
        for core in cores:
            assert float(core.get("r")) == pytest.approx(0.35 * radius, rel=5e-3)
        for one in stands:
            # Told in pixels.
            assert placed(one.get("transform"))(1) == pytest.approx(px, rel=1e-3) and "stroke-width:1" in one.get(
                "style"
            )
    assert len(root.findall(f".//{SPACE}pattern")) == grounded
    for pattern in root.iter(f"{SPACE}pattern"):
        assert float(pattern.get("width")) == float(pattern.get("height")) == pytest.approx(5 * px, rel=5e-3)
        assert numbers(pattern.find(f"{SPACE}path").get("style"))[-1] == pytest.approx(1.2 * px, rel=5e-3)


@pytest.mark.parametrize("k", [1.0, 0.02])
def test_blocks_dots_and_arrows_are_as_large_as_reported(k):
    way = np.exp(0.4j)
    root = still_of(
        SceneMark("slide", ONE * k * (60 + 60j), "construction", "block", direction=ONE * way),
        SceneMark("point", ONE * k * (90 + 30j), "wanted", "dot"),
        SceneMark("vector", ONE * k * 30j, "contact", "long", vector=ONE * k * 50 * way),
        SceneMark("vector", ONE * k * 80, "contact", "short", vector=ONE * k * 3j),
        SceneMark("line", ONE * k * 150, "construction", "link", vector=ONE * k * 40j),
        SceneMark("line", ONE * k * 170, "contact", "line", vector=ONE * k * 40j),
        SceneMark("circle", ONE * k * (300 + 100j), "contact", "circle", radius=np.full(FRAMES, 33.0 * k)),
        bodies=[body(plate(wide=420 * k, high=200 * k))],
    )  # fmt: skip
    ((block,), (dot,), (circle,)) = (drawn(root, name) for name in ("block", "dot", "circle"))
    x, y, wide, high, back = numbers(block.get("d"))
    assert (x, y, wide, high, back) == (-10, -6.5, 20, 13, -20)
    set_there = [placed(one.get("transform")) for one in (titled(root, "block"), block)]
    assert set_there[0](set_there[1](10)) == pytest.approx(k * (60 + 60j + 10 * way), abs=0.01 * k)
    assert (dot.get("class"), float(dot.get("r"))) == ("dot wanted", pytest.approx(3.2 * k))
    assert (circle.get("class"), float(circle.get("r"))) == ("line contact", pytest.approx(33 * k))
    for name, long, head, look in (("long", 50, 7, "arrow contact"), ("short", 3, 3, "arrow contact")):
        (arrow,) = drawn(root, name)
        reported = numbers(arrow.get("d"))
        assert reported[:3] == [0, 0, pytest.approx(long * k)] and arrow.get("class") == look
        back, up, tip, zero, back_too, down = reported[3:]
        assert (back, up) == pytest.approx((k * (long - head), k * 0.4 * head), abs=1e-3 * k)
        assert (tip, zero, back_too, down) == (reported[2], 0, back, -up)
    for name, look in (("link", "link construction"), ("line", "arrow contact")):
        (line,) = drawn(root, name)
        assert numbers(line.get("d")) == [0, 0, pytest.approx(40 * k)] and line.get("class") == look


def test_a_curve_goes_with_its_body_or_lies_on_the_ground_and_is_drawn_once():
    line = gk.plane.Segment(10 + 10j, 60 + 10j)
    curves = (
        SceneCurve(line, "pitch", "on", "plate"),
        SceneCurve(line, "contact", "off"),
        SceneCurve(line, "wanted", "", "bare"),
    )
    at, turn = 100 + 20j, np.exp(0.3j)
    bodies = [body(plate(), "plate", at, turn), body(None, "bare", -at, turn)]
    root = still_of(bodies=bodies, curves=curves)
    for role, where in (
        ("pitch", lambda z: at + turn * z),
        ("contact", lambda z: z),
        ("wanted", lambda z: -at + turn * z),
    ):
        (group,) = [g for g in root.iter(f"{SPACE}g") if any(one.get("class") == f"line {role}" for one in g)]
        (path,) = [one for one in group if one.get("class") == f"line {role}"]
        ((ends,), _) = loops(path.get("d"))
        assert placed(group.get("transform"))(ends) == pytest.approx(where(np.array([10 + 10j, 60 + 10j])), abs=0.02)


@pytest.mark.parametrize("k", [1.0, 2.5])
def test_a_drawing_for_programs_has_circles_for_pins_and_points(k):
    """As wide as the holes that they sit in, or in what is called a pixel of the picture."""
    part = plate((k * (100 + 100j), 5.0 * k), wide=420 * k, high=200 * k)
    marks = {
        "PINS": [(100 + 100j, "pin", "construction", 5), (50 + 50j, "fixed pin", "construction", 3)],
        "WANTED": [(200 + 70j, "point", "wanted", 2.5)],
        "CONSTRUCTION": [(100 + 100j, "point", "construction", 2.5), (250 + 30j, "circle", "construction", 20)],
    }
    given = [
        SceneMark(sort, ONE * k * z, role, radius=np.full(FRAMES, k * radius) if sort == "circle" else None)
        for held in marks.values()
        for z, sort, role, radius in held
    ]
    scene = scene_of(*given, bodies=[body(part, fixed=True)])
    content = assembly_drawing(Job("still", StaticSource((), scene.table, scene), 0.01, assembly_at=0.0))
    space = ezdxf.read(io.StringIO(content.decode())).modelspace()
    for layer, held in marks.items():
        circles = space.query(f'CIRCLE[layer=="{layer}"]')
        found = sorted((c.dxf.center.x, c.dxf.center.y, c.dxf.radius) for c in circles)
        wanted = sorted((k * z.real, k * z.imag, k * radius) for z, _, _, radius in held)
        assert np.array(found) == pytest.approx(np.array(wanted), abs=1e-3 * k)
    (text,) = space.query("TEXT")
    (name,) = place_labels(Still(scene, np.array([0])))
    assert (text.dxf.text, text.dxf.layer) == ("plate", "NAMES")
    assert text.dxf.height == pytest.approx(0.72 * 11 * k, rel=5e-3)
    assert complex(*text.get_placement()[1].vec2) == pytest.approx(name.place, abs=0.06 * k)
