"""Pictures of scenes made by hand, read back: what comes and goes, grows and shrinks, and leaves a trail."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.export.job import Job, StaticSource
from geomkin.export.scene_svg import animation
from geomkin.model.scene import Scene, SceneBody, SceneMark
from geomkin.model.table import Column, Table
from tests.export.stills import motions, pose_at, root_of
from tests.export.test_animation import moving

FRAMES = 9
ALONG = 10.0 * np.arange(FRAMES)


def scene_of(*marks, bodies=(), frames=FRAMES, step=10.0, **more):
    """A scene that is driven by so many deg a frame, one a second."""
    table = Table((Column("angle", "deg", "of the driver", step * np.arange(frames)),))
    closed = np.ones(frames, dtype=bool)
    return Scene(table, np.arange(float(frames)), closed, tuple(bodies), marks=tuple(marks), **more)


def film_of(*marks, **more):
    scene = scene_of(*marks, **more)
    return root_of(animation(Job("film", StaticSource((), scene.table, scene), 0.01)))


def point(gone=(), **more):
    """A point that goes along x, but for the frames at which it is nowhere."""
    place = ALONG + 0j
    place[list(gone)] = np.nan
    return SceneMark("point", place, "traced", **more)


@pytest.mark.parametrize("gone", [[0], [7, 8], [0, 1, 4, 7, 8], [1, 3, 5, 7]], ids=str)
def test_a_point_is_seen_where_it_is_and_nowhere_else(gone):
    root = film_of(point(gone), SceneMark("point", ALONG * 1j, "construction"))
    shown, always = [0.0 if k in gone else 1.0 for k in range(FRAMES)], np.arange(FRAMES) / (FRAMES - 1)
    coming, staying = sorted(motions(root).values(), key=lambda rows: rows[:, 4].min())
    assert np.interp(always, coming[:, 0], coming[:, 4]).tolist() == shown
    there = [k for k in range(FRAMES) if k not in gone]
    assert np.interp(always, coming[:, 0], coming[:, 1])[there] == pytest.approx(ALONG[there], abs=0.01)
    # Before it comes and after it went it stands where it will be or was, and flies through no picture.
    assert set(np.round(coming[:, 1])) <= set(ALONG[there])
    assert (staying[:, 4] == 1).all() and len(staying) == 2 and staying[-1, 2] == pytest.approx(80)
    assert coming[0, 0] == staying[0, 0] == 0 and coming[-1, 0] == staying[-1, 0] == 1


def test_marks_fixed_to_a_body_move_with_it():
    """A block and a pin at places of a plate that turns and goes along, an arrow that turns on it, and one beside it."""
    share = np.arange(FRAMES) / (FRAMES - 1)
    origin, turn = 40 * share + 30j * share**2, np.exp(2j * share)
    part = gk.Part("plate", gk.plane.Polyline(np.array([0, 40, 40 + 20j, 20j])), (), 3.0)
    local = {"block": (30 + 10j, np.exp(0.7j) * np.ones(FRAMES)), "spinning": (10 + 5j, np.exp(3j * share))}
    blocks = [
        SceneMark("slide", origin + turn * place, "construction", name, direction=turn * way)
        for name, (place, way) in local.items()
    ]
    beside = SceneMark("pin", origin + 5 * share + turn * 5, "construction", "beside")
    root = film_of(*blocks, beside, bodies=[SceneBody("plate", (part,), origin, turn)])
    for mark in (*blocks, beside):
        rows, inner = moving(root, mark.label)
        place, turned = pose_at(rows, share)
        # A pixel is a 420th of the picture.
        assert np.abs(place + turned * inner(0) - mark.place).max() < 0.15, mark.label
        if mark.direction is not None:
            seen = turned * (inner(1) - inner(0))
            assert np.abs(np.angle(seen / mark.direction)).max() < 0.02, mark.label
    # What stays where it is on the plate follows the plate's own motion, and has none besides.
    assert len(motions(root)) == 3
