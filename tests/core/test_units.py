"""Lengths in sentences of a recipe in inches, for what is sold in mm."""

from decimal import Decimal

import pytest

from geomkin.core.units import UNITS, mm


@pytest.mark.parametrize(("side", "sign"), [("up", 1), ("down", -1)])
@pytest.mark.parametrize("length", [25.525, 14.7625, 25.4 / 3, 0.1])
def test_limits_keep_to_their_side_in_inches_too(side, sign, length):
    text = UNITS["in"].text(f"{mm(length):{side}6}", keeps_mm=True)
    inches = Decimal(text.partition("(")[2].partition(" in")[0])
    assert 0 <= sign * (inches - Decimal(length) / Decimal("25.4")) < Decimal("0.001")


def test_range_without_width_is_one_number():
    sentence = (
        f"{mm(143.21, 143.24, between=' to '):.4g} and {mm(1, 2, between=' to '):g} and {mm(5, 5, between=' x '):g}"
    )
    assert UNITS["mm"].text(sentence) == "143.2 mm and 1 to 2 mm and 5 x 5 mm"
