"""Filemon's and Waldron's regions, against the signs of random linkages and all directions of a driver."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.synthesis import rectification
from geomkin.synthesis.guidance.guides import FourBars, SliderCranks
from tests.campaign import by_default
from tests.synthesis import driving


def problem(rng, parallel=0):
    """Three random poses, and random places of two pins as the body stands at the first."""
    angles = rng.uniform(-np.pi, np.pi, 3)
    angles[:parallel] = angles[0]
    origins, pins = (rng.normal(size=n) + 1j * rng.normal(size=n) for n in (3, 2))
    return list(zip(origins, angles)), pins


def carried(poses, pin):
    """Places of the body's point that stands there at the first pose, (3, 1)."""
    own = (pin - poses[0][0]) * np.exp(-1j * poses[0][1])
    return np.array([[z + own * np.exp(1j * t)] for z, t in poses])


@pytest.mark.campaign
@pytest.mark.parametrize("parallel", by_default([0, 2], [2]))
def test_the_regions_agree_with_the_branches_of_random_linkages(parallel):
    rng = np.random.default_rng(3 + parallel)
    good = 0
    for _ in range(150):
        poses, (driver, driven) = problem(rng, parallel)
        regions = rectification(poses, driven)
        one, other = carried(poses, driver), carried(poses, driven)
        guides = FourBars(first=one, second=other, pivots=(driving.centre_of(one), driving.centre_of(other)))
        found = guides.defects
        same = bool((found.sign == found.sign[0]).all())
        assert regions.drives(driver) == same
        good += same
        # Without a change of branch and nothing else, it goes through when it is driven in steps.
        case = driving.of_four_bar(one, other, guides.pivots, "crank")
        if driving.goes_through(case)[0]:
            assert same and regions.drivable(driven)
        # Whether there is any driver depends on the direction in which it lies: look all around.
        found = regions.drives(driven + np.exp(1j * np.linspace(0, 2 * np.pi, 2000))).any()
        if found != regions.drivable(driven):
            # It may be narrow.
            assert regions.drives(
                driven + np.exp(1j * np.linspace(0, 2 * np.pi, 1_000_000))
            ).any() and regions.drivable(driven)
    assert 20 < good < 130


def test_the_regions_of_a_slider_agree_with_its_branches():
    rng = np.random.default_rng(5)
    poses = driving.three_poses(rng, 300)
    slid, rail = driving.sliding(poses, rng)
    pins = driving.carried(poses, rng.normal(size=300) + 1j * rng.normal(size=300))
    keep = np.flatnonzero(np.isfinite(slid).all(axis=0))
    found = SliderCranks(first=pins, second=slid, pivot=driving.centre_of(pins), rail=rail, slides=False).defects
    for k in keep:
        regions = rectification(list(zip(poses[0][:, k], np.angle(poses[1][:, k]))), complex(slid[0, k]))
        assert regions.drives(pins[0, k]) == (found.sign[:, k] == found.sign[0, k]).all()


def test_the_circles_have_the_sides_of_the_triangle_as_diameters():
    poses = [(0j, 0.0), (40 + 20j, 0.5), (60 + 60j, 1.4)]
    regions = rectification(poses, 30 + 10j)
    corners = [complex(pole.position) for pole in regions.image_poles]
    # Each is where the body's point is that has one place at two of the poses.
    for corner, (j, k) in zip(corners, [(0, 1), (0, 2), (1, 2)]):
        places = [poses[n][0] + corner * np.exp(1j * poses[n][1]) for n in (j, k)]
        assert places[0] == pytest.approx(places[1])
    for circle in regions.circles:
        on = sum(abs(abs(corner - circle.centre) - circle.radius) < 1e-9 for corner in corners)
        assert on >= 2
    points = grid()
    inside = [sum(abs(z - c.centre) < c.radius for c in regions.circles) for z in points]
    assert (regions.drivable(points) == (np.array(inside) % 2 == 0)).all() and 1 in inside and 2 in inside
    assert all(abs(gk.nearest(line, 30 + 10j)[1]) < 1e-9 for line in regions.lines) and len(regions.lines) == 3


def grid():
    x, y = np.meshgrid(np.linspace(-100, 100, 41), np.linspace(-100, 100, 43))
    return (x + 1j * y).ravel()


def test_parallel_poses_make_lines_of_the_circles():
    regions = rectification([(0j, 0.0), (40 + 20j, 0.0), (60 + 60j, 1.4)])
    kinds = sorted(type(curve).__name__ for curve in regions.circles)
    assert kinds == ["Circle", "Segment", "Segment"]
    assert rectification([(0j, 0.0), (40 + 20j, 0.0), (60 + 60j, 0.0)]).circles == ()


def around(curves, z):
    """How many polygons are around each place, by the angle that they are seen in."""
    count = np.zeros(len(z), dtype=int)
    for curve in curves:
        corners = np.append(curve.vertices, curve.vertices[:1])[:, None] - z
        count += np.abs(np.angle(corners[1:] / corners[:-1]).sum(axis=0)) > np.pi
    return count


@pytest.mark.parametrize("parallel", [0, 2, 3])
def test_shaded_regions_are_exactly_the_invalid_points(parallel):
    rng = np.random.default_rng(11 + parallel)
    shaded = np.zeros(2, dtype=int)
    for _ in range(8):
        poses, (_, driven) = problem(rng, parallel)
        regions, low, high = rectification(poses, driven), -3 - 2j, 3 + 4j
        x, y = np.meshgrid(np.linspace(-2.99, 2.99, 47), np.linspace(-1.99, 3.99, 43))
        z = (x + 1j * y).ravel()
        for k, (drawn, good) in enumerate(
            [(regions.no_driven(low, high), regions.drivable(z)), (regions.no_driver(high, low), regions.drives(z))]
        ):
            wrong = (around(drawn, z) % 2 == 1) == good
            # Chords leave slivers beside circles.
            borders = [*regions.circles, *regions.lines]
            assert all(min(gk.nearest(border, at)[1] for border in borders) < 6e-3 for at in z[wrong].tolist())
            shaded[k] += np.count_nonzero(~good)
            assert all(abs(np.clip(c.vertices.real, -3, 3) - c.vertices.real).max() < 1e-9 for c in drawn)
    assert shaded[1] > 100 and (shaded[0] > 100 or parallel == 3)


def test_unknown_regions_are_refused():
    poses = [(0j, 0.0), (40 + 20j, 0.5), (60 + 60j, 1.4)]
    with pytest.raises(gk.DesignError):
        rectification(poses).drives(1j)
    with pytest.raises(gk.DesignError):
        rectification(poses).no_driver(0j, 1 + 1j)
    with pytest.raises(gk.DesignError):
        rectification(poses).no_driven(1j, 5 + 1j)
    with pytest.raises(gk.DesignError):
        rectification(poses).no_driven(1 + 1j, 1 + 4j)
    with pytest.raises(gk.DesignError):
        rectification([*poses, (1j, 2.0)])
    with pytest.raises(gk.DesignError):
        rectification([*poses[:2], poses[0]])
