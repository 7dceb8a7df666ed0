"""The four-bar by second roads: circles that meet, central differences, 50-digit arithmetic, print."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import geomkin as gk

TURN = np.linspace(0, 2 * np.pi, 361)


@given(st.lists(st.floats(0.1, 10), min_size=4, max_size=4), st.floats(0, 6.28), st.sampled_from([1, -1]))
def test_the_pin_lies_on_both_circles_wherever_the_linkage_closes(lengths, angle, branch):
    ground, crank, coupler, rocker = lengths
    if max(lengths) >= sum(lengths) - max(lengths):
        with pytest.raises(gk.DesignError):
            gk.FourBar(*lengths)
        return
    motion = gk.move(gk.FourBar(*lengths), [angle], branch)
    diagonal = abs(ground - crank * np.exp(1j * angle))
    clearly_open = diagonal > coupler + rocker + 1e-9 or diagonal < abs(coupler - rocker) - 1e-9
    clearly_closed = abs(coupler - rocker) + 1e-9 < diagonal < coupler + rocker - 1e-9
    if clearly_open:
        assert not motion.assembled[0] and np.isnan(motion.rocker.direction[0]) and np.isnan(motion.rocker.omega[0])
    if clearly_closed:
        assert motion.assembled[0]
        assert abs(motion.coupler.point(coupler).position[0] - motion.point("rocker_pin").position[0]) < 1e-12 * sum(
            lengths
        )


def test_coincident_circles_have_no_single_answer():
    rhombus = gk.FourBar(1, 1, 1, 1)
    motion = gk.move(rhombus, [0.0])
    assert not motion.assembled[0] and np.isnan(motion.coupler.direction[0])


@pytest.mark.parametrize(
    ("lengths", "kind"),
    [
        ((100, 30, 90, 70), "crank-rocker"),
        ((30, 100, 90, 70), "double-crank"),
        ((100, 70, 90, 30), "rocker-crank"),
        ((100, 70, 30, 90), "double-rocker"),
        ((3, 2, 3, 2), "change-point"),
        ((3, 2, 2.5, 4), "triple-rocker"),
    ],
)
def test_grashof_type_agrees_with_the_links_that_turn_fully(lengths, kind):
    linkage = gk.FourBar(*lengths)
    assert gk.linkage.grashof_type(linkage) == kind
    turns_fully = bool(gk.move(linkage, TURN + 1e-3).assembled.all())
    assert turns_fully == (kind in ("crank-rocker", "double-crank", "change-point"))


@pytest.mark.parametrize(
    ("lengths", "field"),
    [
        ((1, 1, 1, 5), "rocker"),
        ((0, 1, 1, 1), "ground"),
        ((1, -2, 1, 1), "crank"),
        ((1, 1, np.nan, 1), "coupler"),
        ((1, 1, 1, "a"), "rocker"),
    ],
)
def test_impossible_lengths_are_refused_by_name(lengths, field):
    with pytest.raises(gk.DesignError) as caught:
        gk.FourBar(*lengths)
    assert caught.value.field == field and caught.value.remedy


@pytest.mark.parametrize("size", [1e-7, 0.7 / 3])
def test_change_point_is_recognised_within_rounding_at_any_size(size):
    for lengths in ((7, 3, 3, 7), (5, 2, 5, 2), (4, 1, 3, 6), (6, 3, 1, 4)):
        assert gk.linkage.grashof_type(gk.FourBar(*(size * n for n in lengths))) == "change-point"
        for k in range(4):
            for share in (1e-9, -1e-9):
                near = [size * n * (1 + share * (j == k)) for j, n in enumerate(lengths)]
                assert gk.linkage.grashof_type(gk.FourBar(*near)) != "change-point"
