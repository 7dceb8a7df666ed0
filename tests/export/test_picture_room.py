"""How much of the paper stills take: margins, room for all that is shown, names at the edge, the scale below."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.export.still import Still
from geomkin.model.scene import SceneBody, SceneCurve, SceneMark
from tests.export.test_animated_marks import ALONG, FRAMES, scene_of
from tests.export.test_still_shapes import ONE, body

DISC = gk.Part("disc", gk.plane.Circle(10j, 20.0), (), 3.0)
UP = np.exp(0.5j * np.pi)
# What reaches how far: left, low, right, high, about a plate from -50 to 50 on either axis.
FAR = {
    "a circle": ({"marks": [SceneMark("circle", ONE * (5 + 7j), "contact", radius=np.full(FRAMES, 100.0))]}, (-95, -93, 105, 107)),
    "an arrow": ({"marks": [SceneMark("vector", ONE * 40, "contact", vector=ONE * (60 - 90j))]}, (-50, -90, 100, 50)),
    "a point's whole way": ({"marks": [SceneMark("point", 2 * ALONG + 60j, "traced", trail=True)]}, (-50, -50, 160, 60)),
    "a point": ({"marks": [SceneMark("point", 2 * ALONG + 60j, "traced")]}, (-50, -50, 50, 60)),
    "a body where it stands": ({"bodies": [SceneBody("disc", (DISC,), 60 + 30j + ALONG, ONE * UP)]}, (-50, -50, 70, 50)),
    "a fixed one": ({"bodies": [SceneBody("disc", (DISC,), ONE * -60, ONE * UP, fixed=True)]}, (-90, -50, 50, 50)),
    "a curve on it": (
        {
            "bodies": [SceneBody("bare", (), 60 + 30j + ALONG, ONE * UP)],
            "curves": [SceneCurve(gk.plane.Segment(10 + 0j, 40 + 20j), "pitch", "", "bare")],
        },
        (-50, -50, 60, 70),
    ),
    "a curve": ({"curves": [SceneCurve(gk.plane.Segment(10 + 0j, 40 - 80j), "pitch")]}, (-50, -80, 50, 50)),
    "a curve that runs off": ({"curves": [SceneCurve(gk.plane.Segment(0j, 60 - 900j), "centrode")]}, (-50, -80, 60, 50)),
    "a circle that is too large": (
        {"marks": [SceneMark("circle", ONE * -10, "inflection", radius=np.full(FRAMES, 70.0))]},
        (-80, -70, 60, 70),
    ),
    "what is shown on pages alone": ({"marks": [SceneMark("vector", ONE, "velocity", vector=ONE * 300)]}, (-50, -50, 50, 50)),
}  # fmt: skip


def test_picture_has_room_for_all_it_shows():
    square = gk.Part("square", gk.plane.Polyline(50 * np.array([-1 - 1j, 1 - 1j, 1 + 1j, -1 + 1j])), (), 3.0)
    for what, (held, (left, low, right, high)) in FAR.items():
        curves, marks = tuple(held.get("curves", ())), held.get("marks", ())
        scene = scene_of(*marks, bodies=[body(square, "square"), *held.get("bodies", ())], curves=curves)
        # The disc is in the middle of its chords to a three-hundredth of its size.
        bounds = Still(scene, np.array([0])).bounds
        assert bounds == pytest.approx((complex(left, low), complex(right, high)), abs=0.15), what
