"""A curve from outside, made by the contract alone, is taken by all that takes curves."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.plane.curve import Reversed


class Heart(gk.AbstractCurve):
    """The cardioid r = 2 a (1 - cos t): its cusp at the origin, where it begins and ends. No more than is asked."""

    def __init__(self, a):
        self.a = a

    def point(self, t):
        t = np.asarray(t, dtype=float)
        return 2 * self.a * (1 - np.cos(t)) * np.exp(1j * t)

    def velocity(self, t):
        t = np.asarray(t, dtype=float)
        return 2 * self.a * (np.sin(t) + 1j * (1 - np.cos(t))) * np.exp(1j * t)

    breaks = np.array([0.0, 2 * np.pi])
    closed = True


class Parabola(gk.AbstractCurve):
    """y = x^2 from x = 0 on: open, and it knows its curvature."""

    def point(self, t):
        t = np.asarray(t, dtype=float)
        return t + 1j * t**2

    def velocity(self, t):
        return 1 + 2j * np.asarray(t, dtype=float)

    def curvature(self, t):
        return 2 / (1 + 4 * np.asarray(t, dtype=float) ** 2) ** 1.5

    @property
    def breaks(self):
        return np.array([0.0, 2.0])

    @property
    def closed(self):
        return False


HEART = Heart(3.0)


def test_measures_agree_with_closed_forms():
    """Area 6 pi a^2, length 16 a, curvature 3 / (8 a sin(t / 2)), centroid at -5 a / 3."""
    assert gk.area(HEART) == pytest.approx(6 * np.pi * 9, rel=1e-12)
    assert gk.length(HEART) == pytest.approx(48, rel=1e-12)
    assert gk.plane.centroid(HEART) == pytest.approx(-5, rel=1e-9)
    t = np.linspace(0.5, 5.5, 11)
    assert gk.curvature(HEART, t) == pytest.approx(3 / (24 * np.sin(t / 2)), rel=1e-7)
    assert gk.plane.convexity(Reversed(HEART), -t) == pytest.approx(gk.curvature(HEART, t))
    assert gk.length(Parabola()) == pytest.approx(np.sqrt(17) + np.arcsinh(4) / 4, rel=1e-12)


@pytest.mark.parametrize("tolerance", [0.1, 1e-3])
@pytest.mark.parametrize("curve", [HEART, Parabola()], ids=["heart", "parabola"])
def test_chords_and_arcs_keep_the_tolerance(curve, tolerance):
    z = gk.flatten(curve, tolerance)
    for line in (gk.plane.Polyline(z, None, curve.closed), gk.to_arcs(curve, tolerance)):
        t = np.linspace(curve.breaks[0], curve.breaks[-1], 301)
        _, off = gk.nearest(line, curve.point(t))
        assert off.max() <= tolerance * (1 + 1e-6)
    # The cusp is a corner: it is a point of its own.
    assert not curve.closed or np.abs(z).min() < 1e-12


@pytest.mark.parametrize("left_out", ["point", "velocity", "breaks", "closed"])
def test_incomplete_curve_class_is_refused(left_out):
    said = {name: vars(Heart)[name] for name in ("point", "velocity", "breaks", "closed") if name != left_out}
    with pytest.raises(TypeError):
        type("Part", (gk.AbstractCurve,), said)()
