"""Sizes with units and limits: what fits, in which words it is refused, and that what is advised fits; checks in words."""

import dataclasses
from fractions import Fraction

import numpy as np
import pytest

import geomkin as gk
from geomkin.core.fields import (
    SMALLEST,
    allowed,
    check_quantities,
    entry,
    last_fit,
    quantity,
    rounded_down,
    rounded_up,
)
from geomkin.model.table import xy_columns

LIMITS = [
    ({"above": 0, "unit": "mm"}, "a number above 0, in mm", [1, 0.5, 1e-11], [0, -1, 0.1 * SMALLEST]),
    ({"at_least": 0, "unit": "mm"}, "a number at least 0, in mm", [0, 0.0, 1], [-1e-9, 0.1 * SMALLEST]),
    ({"at_least": 2, "at_most": 5, "unit": "deg"}, "a number at least 2 and at most 5, in deg", [2, 5, 3.3], [1.9, 5.1]),
    ({"above": -1, "below": 1}, "a number above -1 and below 1", [0, 0.99, 1e-15, -1e-15], [1, -1, 7]),
    ({}, "a number", [1e300, -3, 1e-300], []),
    ({"at_least": 3, "whole": True}, "a whole number at least 3", [3, np.int8(4), 10**9], [2, 3.0, 3.5]),
    ({"at_least": 0, "whole": True, "unit": "x"}, "a whole number at least 0, in x", [0, 1], [-1]),
]  # fmt: skip


def made(limits, **more):
    return dataclasses.make_dataclass("Made", [("size", float, quantity("how large", **limits, **more))])


@pytest.mark.parametrize("many", [False, True])
@pytest.mark.parametrize(("limits", "words", "good", "bad"), LIMITS)
def test_a_size_is_held_to_its_limits(limits, words, good, bad, many):
    limits = {"unit": "", **limits}
    kind = made(limits)
    (about,) = (field.metadata for field in dataclasses.fields(kind))
    assert allowed(about) == words
    assert about["description"] == f"how large, {limits['unit']}".removesuffix(", ")
    for value in good:
        check_quantities(kind(value), many)
    for value in [*bad, np.nan, np.inf, -np.inf, True, "1", None, 1j, [3.0], (3.0,)]:
        with pytest.raises(gk.DesignError) as caught:
            check_quantities(kind(value), many)
        tiny = value == 0.1 * SMALLEST
        least = f"give {'0 or ' * ('at_least' in limits)}at least 1e-12 mm"
        assert caught.value.field == "size" and caught.value.remedy == (least if tiny else f"give {words}")
    rows = np.array(good)
    if not many:
        with pytest.raises(gk.DesignError, match="size:"):
            check_quantities(kind(rows), many)
        return
    check_quantities(kind(rows), many)
    for value in bad:
        with pytest.raises(gk.DesignError, match="size:"):
            check_quantities(kind(np.append(rows, value)), many)


def test_of_rows_of_several_lengths_the_other_one_is_named():
    kind = dataclasses.make_dataclass("Made", [(name, float, quantity(name, default=1.0)) for name in "abcd"])
    check_quantities(kind(np.ones(3), 2.0, np.ones(1), np.ones(3)), True)
    for sizes, words in (
        ((np.ones(3), 2.0, np.ones(1), np.ones(4)), "d: found 4 sizes, but 3 of a"),
        ((np.ones(1), np.ones(2), np.ones(2), np.ones(5)), "d: found 5 sizes, but 2 of b"),
        ((np.ones(4), np.ones(2), 1.0, np.ones(1)), "b: found 2 sizes, but 4 of a"),
    ):
        with pytest.raises(gk.DesignError, match=words):
            check_quantities(kind(*sizes), True)


@pytest.mark.parametrize("digits", [2, 7])
def test_a_number_that_is_advised_is_on_the_side_that_works(digits):
    rng = np.random.default_rng(2)
    values = [*(rng.normal(size=300) * 10.0 ** rng.integers(-8, 9, 300)), 0.0072, 1.0, 99.9999999, 0.1, -0.1, 1e22]
    for value in map(float, values):
        up, down = (Fraction(said(value, digits)) for said in (rounded_up, rounded_down))
        step = Fraction(10) ** (int(f"{abs(value):e}".split("e")[1]) + 1 - digits) if value else 0
        assert down <= Fraction(repr(value)) <= up and up - down <= step, value
        assert len(f"{float(up):e}".split("e")[0].rstrip("0").strip("-").replace(".", "")) <= digits


@pytest.mark.parametrize(("good", "bad", "edge"), [(0.0, 10.0, np.pi), (10.0, 0.0, np.pi), (-5.0, 1e9, 7.5)])
def test_the_last_size_that_fits_does_and_no_nearer_one(good, bad, edge):
    fits = lambda size: size <= edge if good < bad else size >= edge  # noqa: E731
    found = last_fit(fits, good, bad)
    assert fits(found) and found == pytest.approx(edge, rel=1e-9)


def test_columns_of_a_place_share_their_size_and_tables_their_length():
    x, y = xy_columns("pin", "mm", "where it is", np.array([3 + 4j, complex(np.nan, np.nan), 1j]))
    assert (x.header, y.header) == ("pin_x_mm", "pin_y_mm")
    assert x.scale[[0, 2]].tolist() == y.scale[[0, 2]].tolist() == [5, 1]
    assert (x.meaning, y.meaning) == ("where it is, x", "where it is, y")
    assert x.values[[0, 2]].tolist() == [3, 0] and y.values[[0, 2]].tolist() == [4, 1] and np.isnan(y.values[1])
    assert gk.Column("speed", "mm/s", "", np.ones(2)).header == "speed_mm_per_s"
    with pytest.raises(gk.DesignError, match=r"columns:"):
        gk.Table((gk.Column("a", "", "", np.ones(3)), gk.Column("b", "", "", np.ones(2))))
    with pytest.raises(gk.DesignError, match="columns:"):
        gk.Table(
            (
                gk.Column("a", "mm", "", np.ones(3)),
                gk.Column("b", "", "", np.ones(3)),
                gk.Column("a_mm", "", "", np.ones(3)),
            )
        )


def test_an_entry_is_left_out_as_its_field_says_and_shows_an_example():
    @dataclasses.dataclass
    class Made:
        needed: str = entry("a word", example="word")
        given: str = entry("another", default="x")
        fresh: list = entry("a row", default_factory=list)
        shown: list = entry("a row", default_factory=list, example=[1])
        yes: bool = entry("whether", default=True)

    one, other = Made("a"), Made("b")
    assert (one.needed, one.given, one.fresh, one.shown, one.yes) == ("a", "x", [], [], True)
    assert one.fresh is not other.fresh
    with pytest.raises(TypeError, match="needed"):
        Made()
    about = {field.name: field.metadata for field in dataclasses.fields(Made)}
    assert [about[name]["examples"] for name in ("needed", "given", "fresh")] == [["word"], ["x"], [[]]]
    assert about["needed"]["description"] == "a word"
