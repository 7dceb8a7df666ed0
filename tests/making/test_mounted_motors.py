"""The motor that a plate carries against the torque of its loads, for each kind of mechanism on a plate."""

import tomllib

import numpy as np
import pytest

import geomkin as gk
from geomkin.making.motors import MOTORS
from tests.texts import template_of


def recipe_with(kind, torque, motor="nema17", **loads):
    table = tomllib.loads(template_of(kind, ["loads"]))
    table["loads"] |= {"torque_n_mm": torque, **loads}
    table["stock"] = {**table.get("stock", {}), "motor": motor, "bore": 5}
    return table


def margin(recipe):
    (check,) = (check for check in gk.load(recipe).checks if check.id == "motor_torque")
    return check.value


@pytest.mark.parametrize(("kind", "ratio"), [("ratchet", 1), ("cycloidal-drive", 10)])
def test_margin_of_a_steady_load_is_that_of_its_share_on_the_shaft(kind, ratio):
    motor, torque = MOTORS["nema17"], 2000
    recipe = recipe_with(kind, torque)
    assert kind == "ratchet" or abs(gk.load(recipe).design.ratio) == ratio
    least = min(motor.torque_n_mm, motor.lasting_torque_n_mm)
    assert margin(recipe) == pytest.approx(least / (torque / ratio), rel=1e-9)


def test_a_geneva_drive_needs_most_where_its_wheel_is_fastest():
    # The wheel of four slots turns at most 1 / (sqrt 2 - 1) times as fast as its crank (Bickford).
    table = recipe_with("geneva", 100, inertia_kg_mm2=0)
    table["geneva"] = {"distance": 60, "slots": 4, "roller": 6, "clearance": 0.2, "tip_width": 3}
    table["stock"].pop("material", None)
    largest = 100 / (np.sqrt(2) - 1)
    assert margin(table) == pytest.approx(MOTORS["nema17"].torque_n_mm / largest, rel=1e-5)


@pytest.mark.parametrize("kind", ["geneva", "ratchet", "cycloidal-drive"])
def test_without_loads_or_motor_there_is_no_such_check(kind):
    table = recipe_with(kind, 20)
    for key in ("loads", "stock"):
        less = {name: value for name, value in table.items() if name != key}
        assert "motor_torque" not in [check.id for check in gk.load(less).checks]
