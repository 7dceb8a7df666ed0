"""Strokes of a hand become wanted paths, and find known linkages with similar curves."""

import tomllib

import numpy as np
import pytest

import geomkin as gk
from geomkin.studio.drafts import Draft
from geomkin.studio.edit import answer
from geomkin.studio.strokes import drawn_recipe, known_linkages, posed_recipe, stroke_points

TURN = np.linspace(0, 2 * np.pi, 200)
HEART = 32 * np.sin(TURN) ** 3 + 2j * sum(a * np.cos(k * TURN) for k, a in enumerate((13, -5, -2, -1), 1))
ELLIPSE = 40 * np.cos(TURN) + 25j * np.sin(TURN) + 7


def places(line):
    return [[float(z.real), float(z.imag)] for z in line]


def apart(one, other):
    """The largest distance of a line from the points of another, both ways, by brute force."""
    away = np.abs(one[:, None] - other)
    return max(away.min(axis=0).max(), away.min(axis=1).max())


def test_a_stroke_is_evenly_spaced_without_the_trembling_of_a_hand():
    rng = np.random.default_rng(3)
    # Slow at first, and not quite closed.
    turn = 2 * np.pi * np.linspace(0, 0.98, 196) ** 2
    drawn = 40 * np.cos(turn) + 25j * np.sin(turn)
    shaking = 0.3 * (rng.normal(size=196) + 1j * rng.normal(size=196))
    points, is_closed = stroke_points(places(drawn + shaking))
    steps = np.abs(np.diff(np.append(points, points[0])))
    assert is_closed and steps.max() < 1.15 * steps.min()
    radius = np.abs(points.real / 40 + 1j * points.imag / 25)
    assert np.abs(radius - 1).max() < 0.02
    ends, is_closed = stroke_points(places(ELLIPSE[:120]))
    assert not is_closed and abs(ends[0] - ELLIPSE[0]) < 0.5 and abs(ends[-1] - ELLIPSE[119]) < 0.5


def test_a_stroke_is_the_path_of_a_recipe_in_its_unit():
    for units, mm in (("mm", 1), ("in", 25.4)):
        text = drawn_recipe("", "linkage", units, places(ELLIPSE), 4)
        wanted = gk.load(text).wanted
        assert wanted.closed and wanted.bars == 4
        assert apart(wanted.places, ELLIPSE) < 4
        written = np.array(tomllib.loads(text)["wanted"]["points"]) @ [1, 1j] * mm
        assert np.allclose(written, wanted.places)
    # Another stroke replaces the points and keeps the rest.
    text += "\n[search]\nseed = 5\n"
    other = tomllib.loads(drawn_recipe(text, "path-generator", "in", places(HEART[:150]), 6))
    assert other["search"] == {"seed": 5} and other["wanted"]["closed"] is False and other["wanted"]["bars"] == 4


@pytest.mark.campaign
def test_a_drawn_ellipse_gets_a_linkage():
    reply = answer("", {}, {"draw": {"points": places(ELLIPSE), "bars": 4}})
    assert not reply["problems"] and reply["kind"] == "path-generator"
    found = gk.load(reply["text"]).design
    assert apart(found.motion.point("coupler_point").position, ELLIPSE) < 1.5


@pytest.mark.campaign
def test_known_linkages_draw_what_their_labels_say():
    known = known_linkages(places(HEART))
    size = np.hypot(np.ptp(HEART.real), np.ptp(HEART.imag))
    away = []
    for linkage in known:
        recipe = gk.load(linkage["text"])
        away.append(apart(recipe.motion.point("coupler_point").position, HEART) / size)
        assert recipe.motion.assembled.all() and linkage["label"].startswith(
            f"{len(recipe.motion.linkage.bodies)} bars"
        )
        *_, (x, y) = linkage["lines"]
        path = recipe.motion.point("coupler_point").position
        assert np.abs((np.array(x) + 1j * np.array(y))[:, None] - path).min(axis=1).max() < 0.02 * size
    assert away[0] < 0.1 and np.all(np.diff(away) > -0.01)
    assert known_linkages(places(ELLIPSE[:100])) == []


@pytest.mark.parametrize("drawn", [None, [], [[0, 0], [1, 1]], [[0, 0]] * 5, [[0, "x"]] * 5, [[0, float("nan")]] * 5])
def test_what_is_no_stroke_is_refused(drawn):
    with pytest.raises(gk.DesignError):
        known_linkages(drawn)
    reply = answer("", {}, {"draw": {"points": drawn}})
    assert reply["problems"] and reply["text"] == ""


@pytest.mark.parametrize(("units", "mm"), [("mm", 1.0), ("in", 25.4)])
def test_poses_begin_a_recipe_and_are_added_to_one(units, mm):
    text = f'kind = "linkage"\nunits = "{units}"\n'
    placed = [[0.0, 0.0, 0.04], [40.123, 20, 30.06], [60, 59.96, -80]]
    refused = answer(text, {}, {"draw": {"poses": placed[:2], "step": 0.1}})
    assert refused["limit"] and refused["text"] == text
    reply = drawn_poses(text, units, placed)
    # To a pixel, and a tenth of a degree.
    assert np.abs(poses_of(reply, mm) - placed).max() < 0.06
    scaled = f"{reply}\n".replace("\n\n[wanted]", "\nscale = 2\n\n[wanted]")
    more = drawn_poses(scaled, units, [[-30, 90, 100]])
    assert np.abs(poses_of(more, mm)[:3] - poses_of(reply, mm)).max() == 0
    assert np.abs(poses_of(more, 2 * mm)[3, :2] - [-30, 90]).max() < 0.11
    for wrong in ("x", [[0, 0]], [[0, 0, "1"]], [[0, 0, float("nan")]], None):
        assert answer(text, {}, {"draw": {"poses": wrong}})["limit"]
    assert answer(text, {}, {"draw": {"poses": placed, "step": 0}})["limit"]


def drawn_poses(text, units, poses):
    draft = Draft(text, {})
    kind = tomllib.loads(text)["kind"]
    return posed_recipe(draft, kind, units, poses, 0.1)


def poses_of(text, mm):
    return np.array(tomllib.loads(text)["wanted"]["poses"]) * [mm, mm, 1]
