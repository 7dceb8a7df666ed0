"""Torque of a machine's driver against the loads of its mechanisms, by the energy that it supplies."""

import numpy as np
import pytest

import geomkin as gk

PAIR = {"kind": "gear-pair", "first": {"teeth": 12, "module": 2, "profile_shift": 0.3},
        "second": {"teeth": 24, "module": 2}}  # fmt: skip
# 10 N along +x on the slider; the parts have no mass.
PUMP = {"kind": "slider-crank", "linkage": {"crank": 20, "coupler": 70}, "drive": {"step_deg": 1},
        "loads": {"forces": [{"body": "slider", "point": "slider_pin", "force_n": [10, 0]}]}}  # fmt: skip
CAM = {"kind": "disk-cam", "loads": {"force_n": 30, "follower": {"mass_kg": 1e-6}},
       "cam": {"base_radius": 30, "follower": {"kind": "translating-roller", "roller_radius": 8}, "program": [{"kind": "rise", "law": "cycloidal", "rise": 12, "end_deg": 150},
                                              {"kind": "return", "law": "cycloidal", "end_deg": 360}]}}  # fmt: skip


def work_of(made):
    angle = np.radians(made.table["driver_angle"])
    steps = np.diff(angle) * (made.torques.input[1:] + made.torques.input[:-1]) / 2
    return np.concatenate([[0], np.cumsum(steps)])


@pytest.mark.parametrize(("phase", "speed"), [(0, 60), (70, 60), (70, -60)])
@pytest.mark.parametrize("body", ["first", "second"])
def test_the_driver_supplies_the_work_against_a_force_on_a_slider(body, phase, speed):
    pair = {"recipe": PAIR}
    pump = {"recipe": PUMP, "turned_by": f"pair.{body}", "phase_deg": phase}
    mechanisms = {"pair": pair, "pump": pump}
    made = gk.load({"kind": "machine", "mechanisms": mechanisms, "drive": {"speed_rpm": speed}})
    x = made.table["pump_slide_displacement"]
    assert np.ptp(x) == pytest.approx(40, abs=0.1)
    assert work_of(made) == pytest.approx(-10 * (x - x[0]), abs=0.01 * 400)


def test_the_driver_supplies_the_work_that_lifts_a_follower_and_its_motor_is_checked():
    stock = {"bore": 6, "bore_form": "D", "motor": "37d-50", "thickness": 6}
    mechanisms = {
        "pair": {"recipe": PAIR | {"first_stock": stock, "second_stock": {"bore": 6}, "base": {}}},
        "lift": {"recipe": CAM, "turned_by": "pair.second"},
        "pump": {"recipe": PUMP, "turned_by": "pair.second"},
    }
    made = gk.load({"kind": "machine", "mechanisms": mechanisms})
    lift, x = made.table["lift_lift"], made.table["pump_slide_displacement"]
    assert work_of(made) == pytest.approx(30 * (lift - lift[0]) - 10 * (x - x[0]), abs=0.01 * 400)
    (check,) = (check for check in made.checks if check.id == "motor_torque")
    # The gear motor's line of torque over speed: 2059 N mm at standstill, 200 rpm without load; here 60 rpm.
    assert check.value <= 2059 * (1 - 60 / 200) / np.abs(made.torques.input).max() + 1e-9
    heavy = CAM | {"loads": CAM["loads"] | {"force_n": 3000}}
    mechanisms["lift"] = mechanisms["lift"] | {"recipe": heavy}
    made = gk.load({"kind": "machine", "mechanisms": mechanisms})
    assert not next(check for check in made.checks if check.id == "motor_torque").passed


def test_a_machine_without_loads_has_no_torque():
    plain = {key: value for key, value in PUMP.items() if key != "loads"}
    mechanisms = {"pair": {"recipe": PAIR}, "pump": {"recipe": plain, "turned_by": "pair.second"}}
    assert gk.load({"kind": "machine", "mechanisms": mechanisms}).torques.input is None
