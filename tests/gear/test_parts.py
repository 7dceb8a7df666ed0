"""Refusals name the key that is wrong, `check` refuses what `run` does, and checks see motors under gears."""

import pytest

import geomkin as gk
from geomkin.build import check_recipe

WHEEL = {"teeth": 40, "module": 2}


def refused(act, recipe):
    with pytest.raises(gk.RecipeError) as error:
        act(recipe)
    (problem,) = error.value.problems
    return problem.key


@pytest.mark.parametrize("angle", [0, 20])
def test_a_web_too_fine_to_cut_is_refused_by_its_own_key_wherever(angle, tmp_path):
    web = {"hub": 16, "rim": 4, "count": 100, "spoke_width": 1e-9}
    recipe = {"kind": "spur-gear", "helix_angle_deg": angle, "gear": WHEEL, "stock": {"bore": 5, "web": web}}
    for act in (check_recipe, lambda given: gk.make(given, tmp_path)):
        assert refused(act, recipe) == "stock.web.spoke_width"


@pytest.mark.parametrize(
    ("bores", "clearance", "key"),
    [((8, 60), 30, "second_stock.bore"), ((60, 8), 30, "first_stock.bore"), ((8, 8), 90, "base.clearance")],
)
def test_of_two_bores_the_wrong_one_is_named(bores, clearance, key):
    from geomkin.gear.parts_assembly import pair_base
    from geomkin.making.assembly import BaseStock

    apart = 30.0 if key != "base.clearance" else 80.0
    with pytest.raises(gk.DesignError) as error:
        pair_base(apart, (40, 40), bores, 6, BaseStock(clearance=clearance if key == "base.clearance" else 0.2))
    assert error.value.field == key


def failed(recipe):
    return [check.name for check in gk.load(recipe).design_checks if not check.passed]


def planetary(planet, sun=24, **others):
    ring = {"teeth": sun + 36, "module": 1, "addendum": 0.8}
    gears = {"sun": {"teeth": sun, "module": 1}, "planet": {"teeth": 18, "module": 1}, "ring": ring}
    return {
        "kind": "planetary",
        "gears": gears,
        "sun_stock": {"bore": 5, "motor": "nema17", "bore_form": "D", "fit": "press"},
        "planet_stock": {"bore": 5, **planet},
        "ring_stock": {"rim": 12},
        **others,
    }


def test_collars_under_a_carrier_keep_off_the_motor_s_plate():
    name = "collars under the carrier beside motor_plate"
    press = {"fit": "press"}
    # 21 mm from the sun's axis to the planets', collars of 10 mm, and a plate of 28.3 mm round the axis.
    assert name in failed(planetary(press))
    (check,) = [c for c in gk.load(planetary(press)).design_checks if c.name == name]
    plate = gk.making.motor_plate("nema17", 6.0)
    reach = abs(plate.outline.point(plate.outline.breaks)).max()
    assert check.value <= 21 - 5 - reach and check.value == pytest.approx(21 - 5 - 28.26, abs=0.01)
    assert name not in failed(planetary(press, sun=60))
    # Glued in the carrier they have their collars above, over a base above it.
    assert name not in failed(planetary({}))
    assert name not in failed(planetary(press, base={}))


def test_a_pinion_rests_beside_the_hole_for_its_motor_s_boss():
    stock = {"bore": 5, "bore_form": "D", "fit": "press", "motor": "nema17"}
    pinion = {"teeth": 12, "module": 1, "profile_shift": 0.3}
    wheel = {"teeth": 60, "module": 1}
    pair = {"kind": "gear-pair", "first": pinion, "second": wheel, "first_stock": stock, "second_stock": {"bore": 8}}
    assert failed(pair | {"base": {}}) == ["first beyond the hole for the motor's boss"]
    assert failed(pair) == []
    assert failed(pair | {"base": {}, "first": {"teeth": 30, "module": 1}}) == []
    rack = {"kind": "rack-and-pinion", "pinion": pinion, "rack": {"teeth": 40, "module": 1}, "stock": stock}
    assert "pinion beyond the hole for the motor's boss" in failed(rack | {"base": {}})
    assert "sun beyond the hole for the motor's boss" in failed(planetary({}, sun=18, base={}))
