"""What a page shows in small: forms of parts, and how plates lie on each other, read back from their SVG."""

import re
import xml.etree.ElementTree as ET
from dataclasses import replace

import numpy as np
import pytest

import geomkin as gk
from geomkin.export.svg_path import path, picture, thumbnail
from geomkin.model.scene import SceneBody
from geomkin.page.sections import stack, tints_of
from geomkin.plane.curve import Moved
from geomkin.plane.vec import Pose
from tests.export.test_film import FRAMES, scene_of
from tests.plane.curves import Flower

ONE = np.ones(FRAMES, dtype=complex)
DISC = gk.plane.Circle(0j, 5.0)


def box_of(svg):
    left, top, wide, high = map(float, svg.get("viewBox").split())
    return complex(left, -top - high), complex(left + wide, -top)


@pytest.mark.parametrize("k", [1e-3, 0.1, 40.0])
def test_a_round_form_is_shown_alike_whatever_its_size(k):
    low, high = box_of(ET.fromstring(thumbnail([((gk.plane.Circle(0j, k),), "")], 64, 44, "")))
    assert (high - low) / k == pytest.approx(0.05 * (64 + 44j), rel=0.02)


@pytest.mark.parametrize("k", [1e-3, 1.0, 4e3])
@pytest.mark.parametrize(("wide", "high"), [(60, 40), (40, 60), (360, 240)])
@pytest.mark.parametrize("size", [100 + 10j, 10 + 100j, 40 + 40j])
def test_a_form_in_small_fills_its_picture_but_for_two_pixels(size, wide, high, k):
    corners = k * (300 - 70j + np.array([0, size.real, size, 1j * size.imag]))
    hole = gk.plane.Circle(complex(corners.mean()), 3 * k)
    curves = (gk.plane.Polyline(corners), hole)
    svg = ET.fromstring(thumbnail([(curves, 'class="plate"'), ((hole,), 'class="mark"')], wide, high, 'id="small"'))
    low, high_end = box_of(svg)
    across = high_end - low
    pixel = max(k * size.real / (wide - 4), k * size.imag / (high - 4))
    # Numbers are told to some twentieths of a pixel.
    assert across == pytest.approx(pixel * complex(wide, high), abs=0.1 * pixel)
    assert (low + high_end) / 2 == pytest.approx(complex(corners.mean()), abs=0.1 * pixel)
    assert svg.get("id") == "small" and [one.get("class") for one in svg] == ["plate", "mark"]
    assert all(one.get("transform") == "scale(1 -1)" for one in svg)
    start = complex(*map(float, re.match(r"M(-?[\d.]+) ?(-?[\d.]+)", svg[0].get("d")).groups()))
    assert start == pytest.approx(complex(corners[0]), abs=0.06 * pixel)


def test_a_form_in_small_is_within_a_quarter_of_a_pixel():
    flower = Moved(Flower(3.0), Pose(70 + 3j))
    svg = ET.fromstring(thumbnail([((flower,), "")], 60, 40, ""))
    low, high = box_of(svg)
    pixel = (high - low).real / 60
    assert pixel == pytest.approx(6.9 / 36, rel=0.02)
    # As fine as that, and no finer.
    digits = len(svg.get("viewBox").split()[0].partition(".")[2])
    told = svg[0].get("d")
    assert told == path([flower], 0.25 * pixel, digits) != path([flower], 0.3 * pixel, digits)
    assert 0.005 < 10.0**-digits / pixel <= 0.1


def test_a_picture_that_stands_alone_fills_what_is_closed_and_says_what_it_is():
    line = gk.plane.Segment(0j, 30 + 4j)
    for curves, marks, fills in (
        ((gk.plane.Circle(0j, 9.0), DISC), (line,), ["#cfe4f3", "none"]),
        ((line,), (), ["none"]),
    ):
        svg = ET.fromstring(picture('<a "part">', curves, marks))
        assert svg.get("aria-label") == '<a "part">' and (svg.get("width"), svg.get("height")) == ("360", "240")
        assert [one.get("fill") for one in svg] == fills
        low, high = box_of(svg)
        assert (high - low).real / (high - low).imag == pytest.approx(1.5, rel=1e-3)


def part(name):
    return gk.Part(name, DISC, (), 3.0)


LONG = "a_very_long_name_that_no_plate_has_room_for"
LAYERS = {7: ["short", "crank_pin", LONG[:38]], 2: ["base"], 3: [LONG[:40], "b"]}


def test_plates_lie_on_each_other_as_in_the_scene():
    bodies = [
        SceneBody(f"{layer} {k}", (part(name),), ONE, ONE, layer, fixed=name == "base")
        for layer, names in LAYERS.items()
        for k, name in enumerate(names)
    ]
    scene = scene_of(bodies=bodies)
    told = stack(scene)
    svg = ET.fromstring(re.search("<svg.*</svg>", told)[0])
    assert svg.get("aria-label") == "From the lowest up, " + "; ".join(
        f"layer {layer}: {', '.join(LAYERS[layer])}" for layer in sorted(LAYERS)
    )
    _, _, wide, high = map(float, svg.get("viewBox").split())
    rects = [one for one in svg if one.tag == "rect"]
    words = [one for one in svg if one.tag == "text" and one.get("class") is None]
    names = [name for layer in sorted(LAYERS, reverse=True) for name in LAYERS[layer]]
    assert len(rects) == len(words) == len(names)
    tints = tints_of(scene)
    assert tints["base"] == "ground" and sorted(tints.values()) == ["ground", *(f"t{k}" for k in range(5))]
    boxes = []
    for rect, word, name in zip(rects, words, names):
        x, y, w, h = (float(rect.get(key)) for key in ("x", "y", "width", "height"))
        boxes.append((x, y, x + w, y + h))
        assert rect.get("class") == f"plate {tints[name]}"
        # In the middle of its plate, with the end left out where it has no room: half of 15 pixels for a letter.
        assert float(word.get("x")) == pytest.approx(x + w / 2, abs=0.6) and y + 10 < float(word.get("y")) < y + h
        whole, seen = name.replace("_", " "), word.text
        assert seen == whole or (seen[-1] == "…" and whole.startswith(seen[:-1]) and 7.5 * (len(seen) + 2) > w - 2)
        assert 7.5 * len(seen) <= w + 1
    rows = dict(zip(names, boxes))
    assert rows["short"][1] < rows["b"][1] < rows["base"][1] and len({box[1] for box in boxes}) == 3
    for k, (left, top, right, bottom) in enumerate(boxes):
        assert 20 <= left < right <= wide and 0 <= top < bottom <= high
        assert all(left >= r or right <= x or top >= b or bottom <= t for x, t, r, b in boxes[:k])
    layers = [one for one in svg if one.get("class") == "layer"]
    assert [one.text for one in layers] == ["7", "3", "2"]
    assert [float(one.get("y")) for one in layers] == [float(words[k].get("y")) for k in (0, 3, 5)]


def test_one_layer_is_no_stack_and_tints_begin_anew():
    bodies = [SceneBody(f"{k}", (part(f"p{k}"),), ONE, ONE, 4) for k in range(10)]
    assert stack(scene_of(bodies=bodies)) == "" and stack(scene_of()) == ""
    assert tints_of(scene_of(bodies=bodies)) == {f"p{k}": f"t{k % 8}" for k in range(10)}
    assert stack(scene_of(bodies=[*bodies, replace(bodies[0], name="up", layer=5)])) != ""
