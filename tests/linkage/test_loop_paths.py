"""Paths of linkages that are no chain of dyads: every frame by a second road, and the work that a path takes."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.linkage.solve.loops import Loops
from tests.linkage.examples import ALL, FEW
from tests.linkage.test_loops import posed, triad

FRAMES = 361


def stepped(cases, drive):
    """Plate poses of many triads, (frames, triads), each frame by Newton's method from the one before it, 1 deg away.

    Distances between pins alone, three unknowns and real sines: none of the engine's equations, and no path.
    """
    bases, corners, bars, starts = (np.array([case[k] for case in cases]) for k in range(4))
    x, found = starts[:, :3].copy(), []
    before, lost = x, np.zeros(len(x), dtype=bool)
    for q in drive.T:
        x, before = 2 * x - before, x
        for _ in range(6):
            turned = np.exp(1j * x[:, 2:]) * corners
            driven = bases * np.exp(1j * q[:, None] * np.array([1, 0, 0]))
            apart = 100 * (x[:, :1] + 1j * x[:, 1:2]) + turned - driven
            slopes = np.stack([np.full_like(apart, 100), np.full_like(apart, 100j), 1j * turned], axis=-1)
            slopes = 2 * np.real(np.conj(apart)[..., None] * slopes)
            # Beyond a limit there is nothing to find.
            slopes[lost] = np.eye(3)
            step = np.linalg.solve(slopes, (np.abs(apart) ** 2 - bars**2)[..., None])[..., 0]
            lost |= np.abs(step).max(axis=1) > 0.3
            x = np.where(lost[:, None], x, x - step)
        found.append(x)
    return np.array(found)


@pytest.mark.parametrize("seeds", [range(100, 108), pytest.param(range(400), marks=pytest.mark.campaign)])
def test_frames_of_random_linkages_are_those_of_newton_s_method_frame_by_frame(seeds):
    cases = [triad(seed) for seed in seeds]
    drive = np.array([start + np.linspace(0, 2 * np.pi, FRAMES) for _, start, _ in cases])
    poses = stepped([data for _, _, data in cases], drive)
    compared = 0
    for k, (linkage, _, _) in enumerate(cases):
        motion = gk.move(linkage, drive[k])
        # Steps of 1 deg follow nothing beside a limit.
        near = ~motion.assembled | (np.nan_to_num(motion.transmission_angle) < 0.15)
        last = int(np.argmax(near)) if near.any() else FRAMES
        place = 100 * (poses[:last, k, 0] + 1j * poses[:last, k, 1])
        assert np.abs(motion.plate.origin.position[:last] - place).max(initial=0) < 1e-10
        assert np.abs(motion.plate.direction[:last] - np.exp(1j * poses[:last, k, 2])).max(initial=0) < 1e-11
        compared += last
    assert compared > 60 * len(cases)


@pytest.mark.parametrize("name", [n for n in FEW if n != "loops"])
def test_slopes_agree_with_differences(name):
    linkage, drive, branch = ALL[name]
    loops = posed(linkage, gk.move(linkage, drive, branch))
    rng, reported = np.random.default_rng(3), 0
    for placement in loops.plans[False]:
        if isinstance(placement, Loops):
            equations = placement.equations
            bodies, columns = len(equations.names), len(equations.columns)
            known = equations.size * rng.normal(size=(5, bodies))
            state = known + 1j * known[::-1], np.exp(1j * rng.normal(size=(5, bodies)))
            unknowns = rng.normal(size=(5, columns))
            here = equations.posed(state, unknowns)
            slopes = equations.jacobian(here, equations.ends(here))
            for column in range(columns):
                poses = [
                    equations.posed(state, unknowns + step * (np.arange(columns) == column)) for step in (1e-5, -1e-5)
                ]
                ends = [equations.conditions(0, [pose], equations.ends(pose)) for pose in poses]
                # Angles of sliders jump by a turn.
                off = np.angle(np.exp(1j * (ends[0] - ends[1]))) / 2e-5
                assert slopes[..., column] == pytest.approx(off, abs=1e-7)
            reported += 1
    assert reported == 1


@pytest.mark.parametrize("name", ["loops", "actuator between moving bars"])
def test_a_row_that_stays_at_one_place_stands_there_at_every_frame(name):
    linkage, drive, _ = ALL[name]
    one = gk.move(linkage, drive[:1])
    for row in (np.full(4, drive[0]), np.array([drive[0], drive[3], drive[0], drive[3]])):
        many = gk.move(linkage, row)
        assert many.assembled.all()
        for body in many.bodies:
            reported = many.bodies[body], gk.move(linkage, row[:2]).bodies[body]
            for what in ("direction", "first", "second"):
                rows = [getattr(one, what) for one in reported]
                assert rows[0] == pytest.approx(np.resize(rows[1], 4), rel=1e-9, abs=1e-12)
            assert reported[0].direction[0] == pytest.approx(one.bodies[body].direction[0], abs=1e-12)


@pytest.mark.parametrize("name", ["loops", "actuator between moving bars"])
def test_drives_too_far_off_are_refused_with_how_far_they_may_be(name):
    """Of an angle forty turns, of a slide as many sizes of the linkage as that is in rad."""
    linkage, drive, _ = ALL[name]
    size = 80 * np.pi * (1 if name == "loops" else max(abs(z) for own in linkage.bodies.values() for z in own.values()))
    for way in (1, -1):
        with pytest.raises(gk.DesignError) as caught:
            gk.move(linkage, drive[0] + way * np.array([0, 1.01 * size])).assembled
        reported = float(caught.value.remedy.split()[3])
        assert reported == pytest.approx(size, rel=1e-5) and caught.value.field == "drive"
        assert gk.move(linkage, drive[0] + way * np.array([0, 0.999 * reported])).assembled[0]
