"""The contract of every curve: derivatives against differences, honest breaks, honest ends."""

import numpy as np
import pytest

from geomkin.plane.curve import AbstractCurve, Reversed, SubCurve
from geomkin.plane.joined import Path, PolarArray
from geomkin.plane.primitives import Circle, Polyline

from .curves import cam_profile, derivative, examples, flank, inside, size

CURVES = examples() | {"flank": flank(), "cam": cam_profile(), "cam reversed": Reversed(cam_profile())}
every_curve = pytest.mark.parametrize("curve", CURVES.values(), ids=CURVES.keys())


@every_curve
def test_velocity_and_curvature_are_derivatives(curve):
    """By central differences; the default curvature of the base class too."""
    t, span = inside(curve)
    expected = derivative(curve.point, t, 2e-3 * span)
    assert np.abs(curve.velocity(t) - expected).max() < 1e-9 * (np.abs(expected).max() + size(curve) / span.min())
    v, acceleration = curve.velocity(t), derivative(curve.velocity, t, 2e-3 * span)
    expected = np.imag(np.conj(v) * acceleration) / np.abs(v) ** 3
    assert np.abs(curve.curvature(t) - expected).max() < 1e-7 * (np.abs(expected).max() + 1 / size(curve))
    t, _ = inside(curve, 33, 0.001)
    expected = curve.curvature(t)
    error = np.abs(AbstractCurve.curvature(curve, t) - expected).max()
    assert error < 1e-8 * (np.abs(expected).max() + 1 / size(curve))


@every_curve
def test_breaks_and_ends(curve):
    """Breaks rise, the curve is continuous there, and `closed` says whether its end is its start."""
    b = curve.breaks
    assert len(b) >= 2 and np.isfinite(b).all() and (np.diff(b) > 0).all()
    before = curve.point(b[1:] - 1e-9 * np.diff(b))
    speed = np.abs(curve.velocity(inside(curve)[0])).max() * np.diff(b).max()
    assert np.abs(before - curve.point(b[1:])).max() < 1e-8 * (speed + size(curve))
    gap = abs(curve.point(b[-1]) - curve.point(b[0]))
    assert curve.closed == (gap < 1e-9 * size(curve))


@every_curve
def test_values_at_a_break_are_those_of_the_piece_that_starts(curve):
    """Velocity by one-sided differences of point: forward at each break, backward at the very end."""
    b = curve.breaks
    h = 1e-3 * np.append(np.diff(b), b[-2] - b[-1])
    weights = np.array([-25, 48, -36, 16, -3]) / 12
    expected = sum(w * curve.point(b + j * h) for j, w in enumerate(weights)) / h
    scale = np.abs(expected).max() + size(curve) / np.diff(b).min()
    assert np.abs(curve.velocity(b) - expected).max() < 1e-8 * scale
    here, beyond = curve.curvature(b), curve.curvature(b + 1e-4 * h)
    finite = np.isfinite(here)
    assert finite.sum() >= len(b) - 1, "only a cusp may be infinite"
    assert np.abs(here - beyond)[finite].max() < 1e-5 * (np.abs(here[finite]).max() + 1 / size(curve))


def zigzag(start: complex) -> Polyline:
    return Polyline(start + np.array([0, 1 + 1j, 2, 3]), None, False)


def test_path_at_a_break_takes_the_piece_that_starts_there():
    """k + 1/3 is no binary number: the way back to the piece's own break must not lose it by rounding."""
    path = Path(tuple(zigzag(3.0 * k) for k in range(8)))
    edges = [p.velocity(p.breaks[:-1]) for p in path.pieces]
    assert np.allclose(path.velocity(path.breaks[:-1]), 3 * np.concatenate(edges))
    back = Reversed(path)
    assert np.allclose(back.velocity(back.breaks[:-1]), -3 * np.concatenate(edges)[::-1])


@pytest.mark.parametrize("half", np.random.default_rng(1).uniform(0.7, 1.5, 3))
def test_ring_at_a_break_answers_for_the_copy_that_starts_there(half):
    """Copies that take any share of t: k spans divided by the span may fall short of k by rounding."""
    count, corner = 31, np.tan(np.pi / 31)
    radius = corner / (np.sin(half) - corner * np.cos(half))
    # A scallop: the part of a circle about 1 within its sector, so that copies meet at an angle.
    ring = PolarArray(SubCurve(Circle(1 + 0j, radius), np.array([-half, half])), count)
    turns = np.exp(2j * np.pi * np.arange(count) / count)
    assert np.allclose(ring.velocity(ring.breaks[:-1]), turns * 1j * radius * np.exp(-1j * half))
    back = Reversed(ring)
    assert np.allclose(back.velocity(back.breaks[:-1]), -turns[::-1] * 1j * radius * np.exp(1j * half))
