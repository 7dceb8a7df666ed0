"""Lines of pictures and drawings read back: arcs of paths, blocks, curves that go with a body, what comes twice."""

import io
import re

import ezdxf
import numpy as np
import pytest

from geomkin.export.dxf import assembly_drawing
from geomkin.export.job import Job, StaticSource
from geomkin.export.still import Still
from geomkin.export.svg_path import path
from geomkin.model.scene import SceneBody, SceneCurve, SceneMark
from geomkin.plane import measure
from geomkin.plane.joined import Path
from geomkin.plane.primitives import Arc, Circle, Polyline, Segment
from tests.export.test_animated_marks import FRAMES, scene_of

NUMBER = r"-?(?:\d+\.?\d*|\.\d+)"


def read(text):
    """Places along a path of relative lines and arcs, as it is stated, and whether it is closed."""
    here, places = 0j, []
    for kind, reported in re.findall(r"([Mla])([^Mlaz]*)", text):
        numbers = [float(one) for one in re.findall(NUMBER, reported)]
        step = complex(*numbers[-2:])
        if kind == "a":
            radius, other, turned, large, left = numbers[:5]
            assert radius == other and turned == large == 0 and left in (0, 1)
            side = 2 * left - 1
            middle = here + step / 2 + side * 1j * step / abs(step) * max(radius**2 - abs(step) ** 2 / 4, 0) ** 0.5
            turn = np.angle((here + step - middle) / (here - middle)) * side % (2 * np.pi)
            places += (middle + (here - middle) * np.exp(1j * side * turn * np.linspace(0, 1, 60)[1:])).tolist()
        else:
            assert len(numbers) == 2
            places.append(here + step)
        here += step
    return np.array(places), text.endswith("z")


OPEN = Path((Segment(-3 + 0j, 1 + 0j), Arc(1 + 5j, 1 + 0j, 0.9), Arc(1 + 5j, 1 + 5j - 5j * np.exp(0.9j), -2.5)))
CLOSED = Path((Arc(0j, 4 + 0j, 2.2), Segment(4 * np.exp(2.2j), -1 - 6j), Arc(1.5 - 3j, -1 - 6j, 2 * np.arctan(5 / 6))))


@pytest.mark.parametrize("k", [0.01, 1.0, 300.0])
def test_a_chain_of_arcs_is_reported_arc_by_arc(k):
    end = CLOSED.pieces[-1].point(1.0)
    chain = Path((*CLOSED.pieces, Segment(complex(end), 4 + 0j)))
    for curve, closed in ((OPEN, False), (chain, True)):
        scaled = Path(tuple(_scaled(piece, k) for piece in curve.pieces))
        text = path([scaled], 1e-3 * k, 4 - round(np.log10(k)))
        places, ends = read(text)
        assert ends == closed == scaled.closed and text.count("a") >= 2
        assert measure.nearest(scaled, places)[1].max() < 2e-3 * k
        assert places[-1] == pytest.approx(complex(scaled.point(scaled.breaks[-1])), abs=2e-3 * k)
        # Each way, and as long as it is.
        length = np.abs(np.diff(places)).sum() + abs(places[0] - places[-1]) * closed
        assert length == pytest.approx(measure.length(scaled), rel=2e-3)


def _scaled(piece, k):
    if isinstance(piece, Segment):
        return Segment(piece.start * k, piece.end * k)
    return Arc(piece.centre * k, piece.start * k, piece.sweep)


TURN = np.exp(0.4j * np.arange(FRAMES))
PLACE = 30j + 5.0 * np.arange(FRAMES)


def drawn(*marks, **more):
    scene = scene_of(*marks, **more)
    content = assembly_drawing(Job("a", StaticSource((), scene.table, scene), 0.01, assembly_at=20.0))
    found = {}
    for entity in ezdxf.read(io.StringIO(content.decode())).modelspace().query("LWPOLYLINE"):
        points = np.array([complex(x, y) for x, y in entity.get_points("xy")])
        found.setdefault(entity.dxf.layer, []).append((points, entity.closed))
    return found, Still(scene, np.array([2]))


def test_a_block_is_drawn_where_it_slides_as_it_lies():
    slide = SceneMark("slide", PLACE, "construction", direction=TURN)
    point = SceneMark("point", PLACE + 100, "traced", direction=TURN)
    found, still = drawn(slide, point)
    ((corners, closed),) = found["PINS"]
    seen = (corners - PLACE[2]) / TURN[2] / still.pixel
    assert closed and seen == pytest.approx(np.array([-10 - 6.5j, 10 - 6.5j, 10 + 6.5j, -10 + 6.5j]), abs=0.01)


def test_curves_go_with_their_bodies_and_nothing_is_reported_twice():
    body = SceneBody("arm", (), PLACE, TURN)
    bent = Polyline(np.array([0, 40, 40 + 20j, 10 + 30j, 1e-9j]))
    doubled = Polyline(np.array([0, 1e-9, 40, 40 + 20j, 40 + 20j + 1e-9, 1e-9j]), is_closed=False)
    there_and_back = Polyline(np.array([0, 30, 30 + 9j, 0j]), is_closed=False)
    nowhere = Polyline(np.array([7, 7 + 1e-9]), is_closed=False)
    curves = [
        SceneCurve(curve, role, "", own)
        for curve, role, own in (
            (bent, "pitch", "arm"),
            (doubled, "wanted", ""),
            (there_and_back, "traced", ""),
            (nowhere, "centrode", ""),
            (Circle(5 + 5j, 20.0), "inflection", "arm"),
            (Segment(1 + 2j, 30 - 4j), "driving", ""),
        )
    ]
    unknown = SceneMark("vector", PLACE + 0j, "contact", vector=np.full(FRAMES, np.nan + 0j))
    found, _ = drawn(unknown, bodies=[body], curves=tuple(curves))
    assert "CONTACT" not in found
    ((corners, closed),) = found["DRIVING"]
    assert not closed and corners == pytest.approx(np.array([1 + 2j, 30 - 4j]))
    ((corners, closed),) = found["PITCH"]
    assert closed and corners == pytest.approx(PLACE[2] + TURN[2] * bent.vertices[:4], abs=1e-5)
    ((corners, closed),) = found["WANTED"]
    assert not closed and corners == pytest.approx(np.array([0, 40, 40 + 20j, 0]))
    ((corners, closed),) = found["TRACED"]
    assert not closed and corners == pytest.approx(np.array([0, 30, 30 + 9j, 0]))
    assert "CENTRODE" not in found
    ((corners, closed),) = found["INFLECTION"]
    assert closed and np.abs(corners - PLACE[2] - TURN[2] * (5 + 5j)) == pytest.approx(20, abs=1e-4)
    # Within the tolerance, or a tenth of what a screen shows: the coarser of the two.
    high = 20 - np.abs(corners + np.roll(corners, 1) - 2 * (PLACE[2] + TURN[2] * (5 + 5j))).min() / 2
    assert 0.005 < high <= 0.01


def test_a_trail_with_a_gap_is_in_two_lines():
    place = PLACE.astype(complex)
    place[[4]] = np.nan
    found, _ = drawn(SceneMark("point", place, "traced", trail=True))
    assert [points.tolist() for points, _ in found["TRACED"]] == [
        pytest.approx(place[:4].tolist()),
        pytest.approx(place[5:].tolist()),
    ]
