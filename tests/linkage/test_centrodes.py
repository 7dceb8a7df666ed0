"""Centrodes that are known curves, that roll on each other, and that break where they must."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.linkage.instant.centrodes import Centrodes
from tests.linkage.examples import bar_that_turns_back

TURN = np.linspace(0.003, 0.003 + 2 * np.pi, 721)
PLACED = {"origin": 12 - 7j, "ground_angle_deg": 33.0}
TRAMMEL = gk.Linkage(
    {"ground": {}, "rod": {"left": 0j, "right": 80 + 0j}, "along": {"left": 0j}, "across": {"right": 0j}},
    driver="rod",
    sliders=(gk.Slider("x", "along", "ground"), gk.Slider("y", "across", "ground", direction_deg=90)),
    **PLACED,
)


def test_the_trammel_rolls_a_circle_inside_one_of_twice_its_size():
    centrodes = Centrodes(gk.move(TRAMMEL, TURN), "rod")
    assert np.abs(np.abs(centrodes.fixed - (12 - 7j)) - 80).max() < 1e-12
    assert np.abs(np.abs(centrodes.moving - 40) - 40).max() < 1e-12
    assert len(centrodes.runs(1000.0)) == 1


@pytest.mark.parametrize(("ground", "crank"), [(60, 100), (100, 60)])
def test_an_antiparallelogram_rolls_ellipses_or_hyperbolas_about_its_pins(ground, crank):
    motion = gk.move(
        gk.FourBar(ground, crank, ground, crank, **PLACED), np.linspace(np.pi + 0.02, 2 * np.pi - 0.02, 90)
    )
    centrodes = Centrodes(motion, "coupler")
    for curve, foci in [
        (centrodes.fixed, [motion.point(name).position for name in ("crank_pivot", "rocker_pivot")]),
        (centrodes.moving, [0, ground]),
    ]:
        away, back = (np.abs(curve - focus) for focus in foci)
        both = away + back if crank > ground else np.abs(away - back)
        assert np.nanmax(np.abs(both - crank) / (away + back)) < 1e-12
    assert len(centrodes.runs(500.0)) == (1 if crank > ground else 2)


LINKAGES = {
    "crank-rocker": (gk.FourBar(100, 30, 90, 70, **PLACED), "coupler"),
    "double-crank": (gk.FourBar(40, 100, 90, 70), "coupler"),
    "slider-crank": (gk.SliderCrank(30, 90, 10, **PLACED), "coupler"),
    "trammel": (TRAMMEL, "rod"),
}


@pytest.mark.parametrize("name", LINKAGES)
def test_the_moving_centrode_rolls_on_the_fixed_one_without_slip(name):
    linkage, body = LINKAGES[name]
    step = 1e-5
    before, now, after = (Centrodes(gk.move(linkage, TURN + dq), body) for dq in (-step, 0, step))
    near = np.abs(now.fixed) < 1000
    fixed = ((after.fixed - before.fixed) / (2 * step))[near]
    moving = ((after.moving - before.moving) / (2 * step) * now.motion.bodies[body].direction)[near]
    # Touching: the same place; rolling: equal steps along one tangent.
    moved = now.motion.bodies[body]
    assert np.abs(moved.origin.position + moved.direction * now.moving - now.fixed)[near].max() < 1e-10
    assert (np.abs(fixed - moving) / (np.abs(fixed) + 1)).max() < 1e-5
    assert (np.abs(fixed - now.velocity[near]) / (np.abs(fixed) + 1)).max() < 1e-5
    fast = Centrodes(gk.move(linkage, TURN, speed=-3.0), body).velocity[near]
    assert np.abs(fast / now.velocity[near] + 3).max() < 1e-12


@pytest.mark.parametrize("name", LINKAGES)
@pytest.mark.parametrize("frames", [73])
def test_runs_are_whole_where_the_centre_is_near_and_never_cross_infinity(name, frames):
    linkage, body = LINKAGES[name]
    drive = np.linspace(0.003, 0.003 + 2 * np.pi, frames)
    reach, finer = 400.0, 64
    centrodes = Centrodes(gk.move(linkage, drive), body)
    between = np.linspace(drive[:-1], drive[1:], finer, axis=1)
    along = Centrodes(gk.move(linkage, between.ravel()), body)
    away = np.abs(along.fixed - along.motion.bodies[body].origin.position).reshape(between.shape)
    drawn = np.zeros(frames - 1, dtype=bool)
    for run in centrodes.runs(reach):
        drawn[run.start : run.stop - 1] = True
    # The whole path of the centre from frame to frame shows whether it stays near.
    assert np.array_equal(drawn, (away[:, 0] <= reach) & (away[:, -1] <= reach) & (away.max(axis=1) < 4 * reach))
    for run in centrodes.runs(reach):
        assert np.isfinite(centrodes.fixed[run]).all() and np.abs(centrodes.moving[run]).max() <= reach


def test_infinity_between_two_frames_breaks_the_curve_at_any_reach():
    motion = gk.move(gk.FourBar(100, 30, 90, 70), TURN)
    turns = np.flatnonzero(np.diff(np.sign(motion.coupler.first)))
    assert len(turns) == 2
    runs = Centrodes(motion, "coupler").runs(np.inf)
    assert [run.stop - 1 for run in runs[:-1]] == turns.tolist()
    assert [run.start - 1 for run in runs[1:]] == turns.tolist()


def test_a_body_that_turns_back_does_not_break_its_centrode():
    linkage, limit = bar_that_turns_back()
    motion = gk.move(linkage, limit + np.linspace(-0.1, 0.1, 20))
    assert np.count_nonzero(np.diff(np.sign(motion.bar.first))) == 1
    assert Centrodes(motion, "bar").runs(1e4) == [slice(0, 20)]


def test_a_change_of_branch_draws_no_line():
    """A kite keeps +1 through its change point: the centre leaps from the crank pivot to 600 mm away."""
    motion = gk.move(gk.FourBar(100, 150, 150, 100), np.linspace(-0.01, 2 * np.pi - 0.01, 91))
    for run in Centrodes(motion, "coupler").runs(1000.0):
        assert np.abs(np.diff(Centrodes(motion, "coupler").fixed[run])).max() < 60
    assert sum(run.stop - run.start for run in Centrodes(motion, "coupler").runs(1000.0)) >= 90


def test_open_frames_are_nan_and_break_the_curve():
    motion = gk.move(gk.FourBar(3, 2, 2.5, 4), np.linspace(-np.pi, np.pi, 91))
    centrodes = Centrodes(motion, "coupler")
    assert np.array_equal(np.isnan(centrodes.moving), ~motion.assembled)
    assert all(motion.assembled[run].all() for run in centrodes.runs(100.0))


def test_a_translating_body_has_none():
    motion = gk.move(gk.FourBar(100, 30, 100, 30), np.linspace(0.1, 3, 9))
    centrodes = Centrodes(motion, "coupler")
    assert np.isnan(centrodes.fixed).all() and np.isnan(centrodes.velocity).all() and centrodes.runs(1e9) == []


@pytest.mark.parametrize("moving", [False, True])
def test_centrode_velocity_agrees_with_differences(moving):
    linkage, body = LINKAGES["crank-rocker"]
    curve = gk.linkage.CentrodeCurve(linkage, body, (0.4, 1.2), moving)
    drive = np.array([1.1, 0.5, 0.8])
    centrodes = Centrodes(gk.move(linkage, drive), body)
    assert curve.point(drive) == pytest.approx(centrodes.moving if moving else centrodes.fixed)
    step = 1e-5
    by_differences = (curve.point(drive + step) - curve.point(drive - step)) / (2 * step)
    assert curve.velocity(drive) == pytest.approx(by_differences, rel=1e-7)
    assert not curve.closed and curve.breaks.tolist() == [0.4, 1.2]


def test_invalid_arguments_are_refused():
    bars = gk.FourBar(100, 30, 90, 70)
    motion, many = gk.move(bars, TURN), gk.move(gk.FourBar(100, np.array([20.0, 30.0]), 90, 70), TURN)
    assert Centrodes(many, "coupler").fixed.shape == (len(TURN), 2)
    for call, field in (
        (lambda: Centrodes(motion, "coupler").runs(0.0), "reach"),
        (lambda: Centrodes(motion, "conrod").fixed, "body"),
        (lambda: gk.linkage.CentrodeCurve(bars, "coupler", (1.2, 0.3)), "span"),
        (lambda: gk.linkage.CentrodeCurve(bars, "coupler", (0.3, 0.3)), "span"),
        (lambda: Centrodes(many, "coupler").runs(100.0), "motion"),
    ):
        with pytest.raises(gk.DesignError) as caught:
            call()
        assert caught.value.field == field
