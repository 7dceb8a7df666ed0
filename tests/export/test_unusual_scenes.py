"""Drawings of assemblies and parts whose names, sizes or places are odd."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.export.cut import cut, decimals
from geomkin.model.machinability import thinnest_walls


def test_a_hole_that_rounds_to_none_is_refused_and_one_that_is_reported_is_cut():
    for tolerance in (0.005, 1.0):
        least = 0.5 * 10.0 ** -decimals(tolerance)
        bar = gk.plane.Polyline(np.array([0, 100, 100 + 50j, 50j]) * (1 + tolerance))
        made = cut(gk.Part("bar", bar, (gk.plane.Circle(20 + 20j, 1.01 * least),), 3.0), tolerance)
        assert len(made.loops) == 2
        with pytest.raises(gk.DesignError, match=f"bar: .* {1.98 * least:.3g} mm"):
            cut(gk.Part("bar", bar, (gk.plane.Circle(20 + 20j, 0.99 * least),), 3.0), tolerance)


def test_a_twisted_part_is_as_thin_as_the_necks_of_its_own_outline():
    """A pad on a neck 0.4 mm wide, on a hub about a hole 9 mm from the hub's edge."""
    edge = [
        12 - 12j,
        12 - 0.2j,
        16 - 0.2j,
        16 - 5j,
        26 - 5j,
        26 + 5j,
        16 + 5j,
        16 + 0.2j,
        12 + 0.2j,
        12 + 12j,
        -12 + 12j,
        -12 - 12j,
    ]
    hole = gk.plane.Circle(0j, 3.0)
    straight = gk.Part("hub", gk.plane.Polyline(np.array(edge)), (hole,), 3.0)
    turned = gk.Part("hub", straight.outline, (hole,), 3.0, twist=gk.Twist(0.3))
    reported = {k: thinnest_walls([part], 0.0)["hub"] for k, part in enumerate((straight, turned))}
    assert reported[0] == pytest.approx(0.4, abs=0.02) and reported[1] == pytest.approx(0.4, abs=0.02)
    # As the hole turns with the teeth of a ring, the outline is as near as it comes anywhere.
    wide = gk.Part(
        "ring",
        gk.plane.Polyline(20 * np.array([1 - 1j, 1 + 1j, -1 + 1j, -1 - 1j])),
        (gk.plane.Circle(10 + 0j, 5.0),),
        3.0,
        twist=gk.Twist(0.3, moves="holes"),
    )
    assert thinnest_walls([wide], 0.0)["ring"] == pytest.approx(5.0, abs=0.02)
