"""A cam's way of turning is its `direction`, whatever sign its speed has."""

import pytest

import geomkin as gk
from geomkin.cam.kinds.disk_cam import DiskCamRecipe


@pytest.mark.parametrize(("direction", "other"), [("clockwise", "counterclockwise"), ("counterclockwise", "clockwise")])
def test_a_negative_speed_is_refused_and_the_direction_named(direction, other):
    program = gk.Program([gk.Rise("3-4-5", rise=9, end_deg=180), gk.Return("3-4-5", end_deg=360)])
    cam = gk.Cam(gk.TranslatingRoller(8), program, 50, direction)
    drive = gk.recipe.Drive(speed_rpm=60.0)
    # Drives of other mechanisms may have such a speed.
    object.__setattr__(drive, "speed_rpm", -60.0)
    with pytest.raises(gk.DesignError) as refused:
        DiskCamRecipe(cam=cam, drive=drive)
    assert refused.value.field == "drive.speed_rpm"
    assert f'direction = "{other}"' in refused.value.remedy and "60" in refused.value.remedy


def test_a_negative_speed_of_a_recipe_is_refused_under_its_key():
    recipe = {"kind": "disk-cam", "drive": {"speed_rpm": -60.0}, "cam": {
        "base_radius": 45, "follower": {"kind": "translating-roller", "roller_radius": 8},
        "program": [{"kind": "rise", "law": "3-4-5", "rise": 12, "end_deg": 150}, {"kind": "return", "law": "3-4-5", "end_deg": 360}],
    }}  # fmt: skip
    with pytest.raises(gk.RecipeError, match="drive"):
        gk.load(recipe)
