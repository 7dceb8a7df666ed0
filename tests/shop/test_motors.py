"""The plate of a motor, read back from its drawing, and where it lies in scenes."""

import dataclasses

import ezdxf
import numpy as np
import pytest

import geomkin as gk
from tests.texts import parse, template_of


def test_the_plate_has_the_face_and_holes_that_makers_draw(tmp_path):
    """42.3 mm square, screws 31 mm apart round the boss of 22 mm, which the corners stand 43.84 mm across from."""
    gk.write(gk.shop.motor_plate("nema17", thickness=3, clearance=0.2), tmp_path / "plate.dxf")
    drawing = ezdxf.readfile(tmp_path / "plate.dxf").modelspace()
    boss, *screws = sorted(drawing.query("CIRCLE"), key=lambda hole: -hole.dxf.radius)
    places = np.array([complex(*hole.dxf.center.vec2) for hole in screws])
    assert boss.dxf.radius == pytest.approx(11.1) and {hole.dxf.radius for hole in screws} == {1.7}
    offsets = places - complex(*boss.dxf.center.vec2)
    assert (
        np.abs(offsets) == pytest.approx(43.84 / 2, abs=0.005) and len({np.round(np.angle(z), 6) for z in offsets}) == 4
    )
    assert np.ptp(places.real) == np.ptp(places.imag) == pytest.approx(31)
    (outline,) = drawing.query("LWPOLYLINE[layer=='CUT']")
    corners = np.array(outline.get_points("xy"))
    assert np.ptp(corners, axis=0) == pytest.approx([42.3, 42.3])


SCREWS = {3.0: "M3 x 6 ", 5.0: "M3 x 8 ", 6.0: "M3 x 10 ", 12.0: "M3 x 16 ", 26.0: "M3 x 30 ", 40.0: "M3 screw, 42 to"}


@pytest.mark.parametrize("thickness", SCREWS)
def test_screws_reach_into_the_motor_and_not_through_its_threads(thickness):
    stock = gk.shop.GearStock(thickness=thickness, bore=5, bore_form="D", motor="nema17")
    recipe = gk.kinds.SpurGearRecipe(gear=gk.SpurGear(24, 2), stock=stock)
    motor, screws = recipe.bought
    assert (motor.name, motor.count) == ("motor NEMA 17, D-shaft 5 mm, 4.5 mm across its flat", 1)
    assert screws.count == 4 and screws.name.startswith(SCREWS[thickness])


KINDS = {"spur-gear": "stock", "gear-pair": "first_stock", "rack-and-pinion": "stock", "planetary": "sun_stock",
         "disk-cam": "stock"}  # fmt: skip


@pytest.mark.parametrize("name", [*KINDS, "rocker-cam", "flat-cam"])
def test_a_motor_adds_its_plate_below_all_and_changes_nothing_else(name):
    plain = parse(template_of(name)) if name in KINDS else gk.load(f"recipes/{name}.toml")
    key = KINDS.get(name, "stock")
    if getattr(plain, "base", None):
        plain = dataclasses.replace(plain, base=None)
    driven = dataclasses.replace(plain, **{key: dataclasses.replace(getattr(plain, key), motor="nema17")})
    assert sorted(part.name for part in driven.parts) == sorted([*(p.name for p in plain.parts), "motor_plate"])
    motor, *others = driven.scene.bodies
    assert (
        motor.name == "motor" and motor.layer == 0 and not motor.origin.any() and motor.parts[0].name == "motor_plate"
    )
    before = {body.name: body for body in plain.scene.bodies}
    assert [body.name for body in others] == list(before)
    for body in others:
        assert body.layer == before[body.name].layer + 1 > motor.layer
        assert (body.origin == before[body.name].origin).all() and len(body.parts) == len(before[body.name].parts)
    assert any("NEMA 17" in one.name for one in driven.bought) and not any("NEMA" in one.name for one in plain.bought)


@pytest.mark.parametrize(("kind", "key"), [("gear-pair", "second_stock"), ("planetary", "planet_stock")])
def test_what_is_driven_by_another_gear_has_no_motor(tmp_path, kind, key):
    plain = parse(template_of(kind))
    with pytest.raises(gk.DesignError, match=rf"{key}\.motor") as caught:
        dataclasses.replace(plain, **{key: gk.shop.GearStock(motor="nema17")})
    assert "give it to" in caught.value.remedy
