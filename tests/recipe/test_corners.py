"""Points given by two distances, held against the distances."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.linkage.kinds.moved import BodyList, TriangleCorner


@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize(("lengths", "size"), [((50.0, 60.0), 1e-3), ((75.0, 30.0), 1.0), ((40.0, 51.0), 1e4)])
def test_a_corner_has_its_distances_and_its_side(lengths, side, size):
    one, two = np.array([3 - 4j, 75 + 50j]) * size
    bodies = {"ground": {"O": 0j}, "plate": {"O": 0j, "A": one, "B": two}}
    corner = TriangleCorner("plate", "pen", ("A", "B"), tuple(np.array(lengths) * size), side)
    pen = BodyList(bodies, "plate", (corner,)).linkage.bodies["plate"]["pen"]
    assert [abs(pen - one), abs(pen - two)] == pytest.approx([length * size for length in lengths], rel=1e-12)
    assert np.sign(np.imag(np.conj(two - one) * (pen - one))) == (1 if side == "left" else -1)


@pytest.mark.parametrize(("base", "lengths"), [(90.0, (50.0, 10.0)), (90.0, (20.0, 110.5)), (12.5, (40.0, 53.0))])
def test_lengths_that_make_no_triangle_are_refused_and_those_that_are_advised_do(base, lengths):
    bodies = {"ground": {"O": 0j}, "plate": {"O": 0j, "A": 3 + 4j, "B": 3 + 4j + 1j * base}}

    def pen(lengths):
        corners = (
            TriangleCorner("plate", "q", ("O", "A"), (5.0, 6.0)),
            TriangleCorner("plate", "p", ("A", "B"), lengths),
        )
        return BodyList(bodies, "plate", corners).linkage.bodies["plate"]["p"]

    with pytest.raises(gk.DesignError) as caught:
        pen(lengths)
    assert caught.value.field == "corners[1]"
    # As little within both limits as beyond them.
    longer = max(lengths)
    for good, bad in (
        ((longer, longer + base - 1e-6), (longer, longer + base + 1e-6)),
        ((base / 3, base * 2 / 3 + 1e-6), (base / 3, base * 2 / 3 - 1e-6)),
        ((longer + base - 1e-6, longer), (longer + base + 1e-6, longer)),
    ):
        assert abs(pen(good) - (3 + 4j)) == pytest.approx(good[0])
        with pytest.raises(gk.DesignError, match="no triangle"):
            pen(bad)


def test_a_corner_stands_on_points_that_its_body_has():
    bodies = {"ground": {"O": 0j}, "plate": {"O": 0j, "A": 30 + 0j}}
    for base, lacking in ((("O", "X"), "X"), (("Y", "A"), "Y"), (("Y", "X"), "Y")):
        with pytest.raises(gk.DesignError) as caught:
            BodyList(bodies, "plate", (TriangleCorner("plate", "p", base, (20.0, 20.0)),))
        assert caught.value.field == "corners[0]" and lacking in caught.value.problem
    # One corner may stand on another that comes before it.
    corners = (
        TriangleCorner("plate", "p", ("O", "A"), (20.0, 20.0)),
        TriangleCorner("plate", "q", ("p", "A"), (9.0, 15.0)),
    )
    q = BodyList(bodies, "plate", corners).linkage.bodies["plate"]["q"]
    assert abs(q - (15 + 1j * np.sqrt(175))) == pytest.approx(9) and abs(q - 30) == pytest.approx(15)
    with pytest.raises(gk.DesignError, match="plate has no point p"):
        BodyList(bodies, "plate", corners[::-1])
