"""How much of the paper stills take: margins, room for all that is shown, names at the edge, the scale below."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.export.labels import place_labels
from geomkin.export.still import Still
from geomkin.model.scene import SceneBody, SceneCurve, SceneMark
from tests.export.stills import SPACE
from tests.export.test_animated_marks import ALONG, FRAMES, scene_of
from tests.export.test_still_shapes import ONE, body, numbers, plate, still_of


@pytest.mark.parametrize("k", [0.003, 40.0])
def test_a_picture_has_a_margin_round_all_that_is_shown_and_a_round_length_below(k):
    root = still_of(bodies=[body(plate(wide=420 * k, high=200 * k), at=k * (7 - 5j), named=False)], at=20.0)
    left, top, wide, high = map(float, root.get("viewBox").split())
    assert (left, top) == pytest.approx((k * (7 - 14), -k * (195 + 14)), abs=0.06 * k)
    assert (wide, high) == pytest.approx((k * (420 + 28), k * (200 + 28 + 22)), abs=0.12 * k)
    assert root.get("width") == f"{root.get('viewBox').split()[2]}mm" and root.get("width")[0].isdigit()
    (scale,) = [one for one in root.findall(f"{SPACE}path") if one.get("d", "").startswith("M")]
    x, over, under, start, level, end, *_ = numbers(scale.get("d"))
    assert (start, x) == pytest.approx((k * -7 + k * 14, k * -7 + k * 14), abs=0.06 * k)
    assert (over, under) == pytest.approx((level - 4 * k, level + 4 * k), abs=0.06 * k)
    assert level == pytest.approx(k * (5 + 14 + 22 - 12), abs=0.06 * k)
    # The largest of 1, 2, 5, 10 and so on that takes less than three tenths of the width.
    lengths = np.outer(10.0 ** np.arange(-4, 6), [1, 2, 5]).ravel()
    assert end - start == pytest.approx(lengths[lengths <= 0.3 * 448 * k].max(), rel=1e-3)
    (words,) = [one for one in root.iter(f"{SPACE}text") if one.get("class") == "scale"]
    assert words.text == f"{end - start:.6g} mm, angle 20°"
    assert (float(words.get("x")), float(words.get("y"))) == pytest.approx((end + 6 * k, level + 4 * k), abs=0.06 * k)


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


def test_a_picture_has_room_for_all_that_it_shows_and_follows_what_runs_off_so_far():
    square = gk.Part("square", gk.plane.Polyline(50 * np.array([-1 - 1j, 1 - 1j, 1 + 1j, -1 + 1j])), (), 3.0)
    for what, (held, (left, low, right, high)) in FAR.items():
        curves, marks = tuple(held.get("curves", ())), held.get("marks", ())
        scene = scene_of(*marks, bodies=[body(square, "square"), *held.get("bodies", ())], curves=curves)
        # The disc is in the middle of its chords to a three-hundredth of its size.
        bounds = Still(scene, np.array([0])).bounds
        assert bounds == pytest.approx((complex(left, low), complex(right, high)), abs=0.15), what


def test_names_at_the_edge_have_room_for_all_their_letters():
    """A point at each corner, whose name stands outward of it."""
    corners = {"first one": 0j, "second one": 420 + 0j, "third one": 420 + 200j, "fourth one": 200j}
    root = still_of(*(SceneMark("point", ONE * z, "wanted", name) for name, z in corners.items()))
    still = Still(
        scene_of(*(SceneMark("point", ONE * z, "wanted", name) for name, z in corners.items())), np.array([0])
    )
    ends = np.array([(n.place - n.half, n.place + n.half) for n in place_labels(still)])
    left, top, wide, high = map(float, root.get("viewBox").split())
    low, most = min(ends.real.min(), 0.0), max(ends.real.max(), 420.0)
    assert (left, left + wide) == pytest.approx((low - 14, most + 14), abs=0.06)
    assert (-top, -top - high) == pytest.approx(
        (max(ends.imag.max(), 200) + 14, min(ends.imag.min(), 0) - 14 - 22), abs=0.06
    )
