"""Refusals of plates word by word, their figures measured another way, and the numbers that they advise tried."""

import re

import numpy as np
import pytest

import geomkin as gk
from geomkin.core.errors import DesignError
from geomkin.gear.parts import GearStock, Web, gear_parts
from geomkin.gear.parts_assembly import rack_base
from geomkin.plane import region

WHEEL = gk.SpurGear(40, 2)


def refusal(call, *given, **named):
    with pytest.raises(DesignError) as caught:
        call(*given, **named)
    return caught.value.field, caught.value.problem, caught.value.remedy


def number(words):
    return float(re.search(r"(?:than|least|most) (\S+)", words)[1])


def wheel(hub, rim, form="spokes", count=5, spoke_width=4.0, bore=10):
    web = Web(hub=hub, rim=rim, form=form, count=count, spoke_width=spoke_width)
    return gear_parts(WHEEL, GearStock(bore=bore, web=web))[0]


def test_a_rim_is_advised_that_leaves_room_between_it_and_the_hub():
    field, _, remedy = refusal(wheel, 30, 30)
    assert field == "stock.web.rim"
    assert number(remedy) == pytest.approx(np.abs(gk.flatten(WHEEL.outline, 1e-4)).min() - 15, abs=1e-3)
    assert len(wheel(30, number(remedy) - 1e-3).holes) == 6
    assert refusal(wheel, 30, number(remedy))[0] == "stock.web.rim"


def test_round_openings_are_refused_by_the_wall_between_them():
    field, problem, remedy = refusal(wheel, 20, 3, "holes", 12)
    assert field == "stock.web.count" and remedy
    count, wide, between = (float(word) for word in re.findall(r"-?\d+\.?\d*", problem))
    assert count == 12 and wide == pytest.approx(24.5)
    # Holes that run into each other have less than nothing between them.
    assert between == pytest.approx(abs(np.exp(2j * np.pi / 12) - 1) * (10 + wide / 2) - wide, abs=5e-3)
    loops = [gk.flatten(hole, 1e-4) for hole in wheel(20, 3, "holes", 4, 0.01).holes[1:]]
    assert wide == pytest.approx(np.ptp(np.abs(loops[0])), abs=1e-3)
    gap = region.gap(loops[0], loops[1])
    assert len(wheel(20, 3, "holes", 4, gap - 0.01).holes) == 5
    assert refusal(wheel, 20, 3, "holes", 4, gap + 0.01)[0] == "stock.web.count"


def test_spokes_are_refused_where_they_meet_outside_the_hub():
    assert refusal(wheel, 20, 3, "spokes", 8, 9.0)[0] == "stock.web.spoke_width"
    widths = np.arange(1, 9, 0.02)
    passes = [_passes(20, 8, width) for width in widths]
    widest = widths[passes.index(False) - 1]
    assert not any(passes[passes.index(False) :])
    # Of the hub's edge next to nothing is left between two of the widest.
    window = gk.flatten(wheel(20, 3, "spokes", 8, widest).holes[1], 1e-4)
    edge = window[np.abs(window) < 10 + 1e-3]
    assert 0 < np.abs(edge[:, None] - edge).max() < 0.2
    assert _passes(30, 8, widest + 0.5) and _passes(20, 7, widest + 0.5)


def _passes(hub, count, width):
    try:
        return len(wheel(hub, 3, "spokes", count, width).holes) == 1 + count
    except DesignError:
        return False


@pytest.mark.parametrize(("module", "height"), [(2.5, 4.0), (2.0, 7.0)])
def test_a_rack_as_long_as_the_refusal_says_holds_its_two_pins(module, height):
    def base(teeth):
        bar = gk.gear.GearRack(teeth, module, height=height)
        (plate,) = gear_parts(bar, GearStock(), "rack")
        pair = gk.gear.RackPair(gk.SpurGear(14, module, 0.2), bar)
        return rack_base(pair, plate, 8.0)

    field, _, remedy = refusal(base, 2)
    assert field == "rack.teeth"
    least = int(number(remedy.replace(",", " ")))
    assert len(base(least)[0].holes) == 2 and refusal(base, least - 1)[2] == remedy


@pytest.mark.parametrize("bar_width", [6.0, 14.0])
def test_the_ground_is_as_large_as_the_face_of_its_motor_or_as_far_about_its_corners_as_bars_are_wide(bar_width):
    stock = gk.linkage.LinkStock(bar_width=bar_width, pin_diameter=3, motor="nema17")
    motion = gk.move(gk.FourBar(100, 30, 90, 70), np.linspace(0, 2 * np.pi, 61))
    ground = gk.linkage.link_parts(motion, stock)[0]
    z = gk.flatten(ground.outline, 1e-5)
    # Corners are as round as half a bar, from places 4 mm within the face at most.
    beyond = 42.3 / 2 + max(0.0, bar_width / 2 - 4)
    assert ground.body == "ground"
    assert (-z.real.min(), -z.imag.min(), z.imag.max()) == pytest.approx((beyond, beyond, beyond), abs=1e-4)
