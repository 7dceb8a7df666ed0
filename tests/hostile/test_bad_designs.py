"""Sizes that no mechanism can have, each refused with the key to change, what was found and what to do."""

import pytest

DWELL = '{kind = "dwell", end_deg = 90}'
RISE = '{kind = "rise", law = "cycloidal", rise = 20, end_deg = 180}'
RETURN = '{kind = "return", law = "harmonic", end_deg = 360}'
# Multiplied by one length, mm, these stock keys keep a linkage's proportions.
SCALED = {
    "linkage.ground": 100,
    "linkage.crank": 30,
    "linkage.coupler": 90,
    "linkage.rocker": 70,
    "stock.bar_width": 14,
    "stock.pin_diameter": 4,
    "stock.clearance": 0.2,
}


def test_an_invalid_four_bar_is_refused(run, refused, recipe):
    for changes, key, word in [
        ({"linkage.ground": "1000"}, "linkage.ground", ""),
        ({"linkage.crank": "0"}, "linkage.crank", "above 0"),
        ({"linkage.crank": "1e-400"}, "linkage.crank", "above 0"),
        ({"linkage.coupler_point": "[1e-12, 0]"}, "linkage.coupler_point", ""),
        ({"linkage.coupler_point": "[1e6, 0]"}, "", "100000"),
        ({"linkage.coupler_point": "[1e308, 1]"}, "linkage", ""),
        ({"stock.bar_width": "4.2000001"}, "", ""),
        ({"stock.clearance": "-1"}, "stock.clearance", "at least 0"),
        ({"stock.thickness": "1e-9"}, "stock.thickness", ""),
        ({"stock.thickness": "1e308"}, "stock.thickness", ""),
        ({"files.kerf": "5", "files.curves": '"arcs"'}, "files.kerf", ""),
        ({"files.tolerance": "1e-9"}, "files.tolerance", ""),
        ({"files.tolerance": "9"}, "", ""),
        ({"drive.step_deg": "400"}, "drive.step_deg", ""),
    ]:
        refused(run(recipe("four-bar", changes)), key, word)


@pytest.mark.parametrize("unit", [1e-200, 1e5, 1e300])
def test_a_linkage_too_small_or_too_large_to_cut_is_reported_with_a_key_of_the_recipe(run, refused, recipe, unit):
    sizes = {key: repr(value * unit) for key, value in SCALED.items()}
    refused(run(recipe("four-bar", sizes | {"linkage.coupler_point": "[0, 0]"})), many=True)


def test_an_invalid_program_is_refused(run, refused, recipe):
    for program, key, word in [
        ("[]", "cam.program", "360"),
        (f"[{RETURN}]", "cam.program[0].end_lift", ""),
        (f"[{DWELL}, {RISE}, {RETURN[:-4]}720}}]", "cam.program", "360"),
        (f"[{RISE}, {DWELL}, {RETURN}]", "cam.program[1].end_deg", ""),
        (f"[{DWELL}, {RISE[:-1]}, start_deg = 80}}, {RETURN}]", "cam.program[1].start_deg", ""),
        (f'[{{kind = "dwell"}}, {RISE}, {RETURN}]', "cam.program[0].end_deg", ""),
        (f"[{DWELL}, {RISE[:-1]}, end_lift = 20}}, {RETURN}]", "cam.program[1].rise", ""),
        (f"[{DWELL}, {RISE}, {RETURN[:-1]}, end_lift = 3}}]", "cam.program", ""),
        (f"[{DWELL}, {RISE.replace('20', '1e160')}, {RETURN}]", "cam.program", ""),
        (f"[{DWELL[:-1]}, rise = 3}}, {RISE}, {RETURN}]", "cam.program[0].rise", ""),
    ]:
        result = run(recipe("disk-cam", {"cam.program": program}))
        refused(result, key, word)
        assert "program.program" not in result.stderr


def test_an_invalid_cam_is_refused(run, refused, recipe):
    for changes, key, word in [
        ({"cam.base_radius": "0"}, "cam.base_radius", "above 0"),
        ({"cam.base_radius": "1e160"}, "cam.base_radius", ""),
        ({"cam.follower.roller_radius": "1e160"}, "cam.follower.roller_radius", ""),
        ({"cam.follower.roller_radius": "10", "cam.follower.offset": "50"}, "cam.follower.offset", "below 50"),
        ({"stock.bore": "1e-9"}, "stock.bore", ""),
        ({"files.kerf": "4"}, "files.kerf", ""),
    ]:
        if any(name.startswith("cam.follower.") for name in changes):
            plain = {"cam.follower.kind": '"translating-roller"', "cam.follower.roller_radius": "10"}
            changes = {"cam.follower": None} | plain | changes
        refused(run(recipe("disk-cam", changes)), key, word)


def test_a_roller_that_undercuts_is_reported_and_the_cam_is_what_it_leaves(run, recipe):
    short = f"[{DWELL}, {RISE.replace('180', '100')}, {RETURN}]"
    follower = '{kind = "translating-roller", roller_radius = 30}'
    result = run(recipe("disk-cam", {"cam.follower": follower, "cam.program": short}))
    assert result.exit_code == 0 and "lift lost to undercut" in result.stderr


def test_an_invalid_gear_is_refused(run, refused, recipe):
    for changes, key, word in [
        ({"gear.teeth": "0"}, "gear.teeth", ""),
        ({"gear.teeth": "24.0"}, "gear.teeth", ""),
        ({"gear.teeth": "10_000_000"}, "gear.teeth", ""),
        ({"gear.module": "1e-300", "stock.bore": "0"}, "gear", ""),
        ({"gear.module": "1e160", "files.write": '["csv"]'}, "gear", ""),
        ({"gear.profile_shift": "-10"}, "gear.profile_shift", "at least -1.632"),
        ({"gear.profile_shift": "1e300"}, "gear.profile_shift", "found 1e+300"),
        ({"gear.rack.pressure_angle_deg": "90"}, "gear.rack.pressure_angle_deg", ""),
        ({"gear.rack.tip_radius": "1"}, "gear.rack.tip_radius", ""),
        ({"gear.rack.dedendum": "1e300"}, "gear.rack.dedendum", ""),
        ({"stock.bore": "-1"}, "stock.bore", "at least 0"),
        ({"stock.thickness": "1e-12"}, "stock.thickness", ""),
        ({"files.tolerance": "5"}, "", ""),
    ]:
        refused(run(recipe("spur-gear", changes)), key, word)


def test_an_invalid_ring_is_refused(run, refused, recipe):
    for changes, key, word in [
        ({"gear.teeth": "24"}, "gear.teeth", "at least 25"),
        ({"gear.module": "1e300"}, "gear.module", ""),
        ({"gear.module": "1e5"}, "", "100000"),
        ({"gear.profile_shift": "9"}, "gear", ""),
        ({"gear.tooth_thickness_allowance": "2"}, "gear.tooth_thickness_allowance", "at most 1.89"),
        ({"gear.tooth_thickness_allowance": "-0.1"}, "gear.tooth_thickness_allowance", "at least 0"),
        ({"gear.cutter.tip_radius": "1"}, "gear.cutter.tip_radius", ""),
        ({"stock.rim": "0"}, "stock.rim", "at least 0.1"),
        ({"stock.bore": "8"}, "stock.bore", ""),
    ]:
        refused(run(recipe("ring-gear", changes)), key, word)
