"""Scenes of linkages: how long arrows are, where instant centres are seen, how time passes, what is drawn as lines."""

import re

import numpy as np
import pytest

import geomkin as gk
from geomkin.linkage import linkage_scene
from geomkin.linkage.scene import vector_marks
from tests.gallery import marks

TURN = np.linspace(0, 2 * np.pi, 61)
BAR = gk.FourBar(100, 30, 90, 70, coupler_point=40 + 25j)


def scene_of(linkage, drive=TURN, **more):
    motion = gk.move(linkage, drive, **more)
    return motion, linkage_scene(motion, gk.linkage.motion_table(motion))


def crossing(a, b, c, d):
    """Of the lines through a and b, and through c and d."""
    one, two = b - a, d - c
    return a + one * np.imag(np.conj(two) * (c - a)) / np.imag(np.conj(two) * one)


def test_visible_instant_centres_lie_where_links_cross():
    motion, scene = scene_of(gk.FourBar(100, 60, 95, 75))
    found = {mark.label: mark.place for mark in marks(scene, "point", "instant centre of")}
    at = {name: motion.point(name).position for name in motion.linkage.pins}
    pivots, pins = ("crank_pivot", "rocker_pivot"), ("crank_pin", "rocker_pin")
    wanted = {
        "instant centre of ground and coupler": crossing(at[pivots[0]], at[pins[0]], at[pivots[1]], at[pins[1]]),
        "instant centre of crank and rocker": crossing(at[pivots[0]], at[pivots[1]], at[pins[0]], at[pins[1]]),
    }
    assert {frozenset(re.split(" and |centre of ", label)[1:]) for label in found} == {
        frozenset(re.split(" and |centre of ", label)[1:]) for label in wanted
    }
    for label, place in wanted.items():
        (shown,) = [held for other, held in found.items() if set(other.split()) == set(label.split())]
        with np.errstate(invalid="ignore"):
            near = np.abs(place) < 3 * float(np.max(motion.linkage.size))
        assert 0 < near.sum() < motion.assembled.sum() and np.array_equal(np.isfinite(shown), near)
        assert np.abs(shown - place)[near].max() < 1e-6


@pytest.mark.parametrize("speed", [3.0, -40.0])
def test_arrows_are_reported_with_their_scale_and_cut_off_where_they_would_cover_all(speed):
    motion, scene = scene_of(BAR, speed=speed)
    size = float(np.max(motion.linkage.size))
    for role, unit in (("velocity", "mm/s"), ("acceleration", "mm/s2")):
        arrows = {mark.label.split(f" {role}")[0]: mark for mark in scene.marks if mark.role == role}
        assert set(arrows) == {"crank_pin", "rocker_pin", "coupler_point"}
        scales = {re.search(rf", 1 mm is (\S+) {re.escape(unit)}$", mark.label)[1] for mark in arrows.values()}
        (scale,) = map(float, scales)
        most = []
        for name, mark in arrows.items():
            track = motion.point(name)
            assert np.array_equal(mark.place, track.position)
            real = getattr(track, role)
            wanted = real / scale
            long = np.abs(wanted) > 0.745 * size
            assert np.abs(mark.vector - wanted)[~long].max() < 6e-3 * size
            assert np.abs(np.abs(mark.vector)[long] - 0.75 * size).max(initial=0) < 6e-3 * size
            assert np.abs(np.angle(mark.vector / real)).max() < 1e-9
            most.append(np.percentile(np.abs(wanted), 95))
        assert max(most) == pytest.approx(0.5 * size, rel=6e-3)
    assert not [
        mark
        for mark in linkage_scene(motion, gk.linkage.motion_table(motion), rates=False).marks
        if "1 mm is" in mark.label
    ]


@pytest.mark.parametrize(
    ("drive", "more", "time", "cyclic"),
    [
        (TURN, {"speed": -4.0}, TURN / 4, True),
        (-2 * TURN, {"speed": 4.0}, 2 * TURN / 4, True),
        (1.5 + TURN, {"speed": 2.0}, TURN / 2, True),
        (0.9 * TURN, {"speed": 2.0}, 0.9 * TURN / 2, False),
        (TURN, {"speed": 0.0}, np.linspace(0, 2, 61), True),
        (TURN, {"speed": 2.0, "acceleration": 0.5}, np.linspace(0, 2, 61), True),
        (0 * TURN + 1, {"speed": 2.0}, 0 * TURN, False),
    ],
)
def test_time_passes_as_the_driver_does_or_in_two_seconds(drive, more, time, cyclic):
    _, scene = scene_of(BAR, drive, **more)
    assert scene.time == pytest.approx(time) and scene.cyclic == cyclic


def test_block_lies_along_its_inclined_slide():
    motion = gk.move(gk.SliderCrank(30, 100, ground_angle_deg=40), np.linspace(0, 6, 7))
    shown = linkage_scene(motion, gk.linkage.motion_table(motion))
    (mark,) = marks(shown, "slide")
    way = np.diff(motion.point("slider_pin").position)
    assert np.abs(np.imag(way / mark.direction[1:])).max() < 1e-9


def test_an_arrow_that_is_known_nowhere_does_not_change_the_others():
    place, unknown = np.zeros(3, complex), np.full(3, complex(np.nan, np.nan))
    motion = gk.move(BAR, TURN[:3])
    alone, with_unknown = (
        list(vector_marks(motion, arrows, "velocity", "mm/s"))
        for arrows in ({"pen": (place, place + 2)}, {"pen": (place, place + 2), "lost": (place, unknown)})
    )
    assert np.array_equal(with_unknown[0].vector, alone[0].vector) and np.isnan(with_unknown[1].vector).all()
