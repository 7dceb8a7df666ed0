"""Handles of all kinds: how much of a recipe they reach, and where a dragged element then is."""

import tomllib
from pathlib import Path

import numpy as np
import pytest

import geomkin as gk
from geomkin.core.field_visitor import numbers_in
from geomkin.studio.edit import answer

RECIPES = sorted(Path("recipes").glob("*.toml"))
# Tables of what is bought, cut from and written, fits, and steps of tables are no sizes of a mechanism.
NO_SIZES = ("stock", "base", "files", "allowance", "clearance", "backlash", "step")
# The least share of lengths and positions with a handle.
LEAST_SHARE = 0.9


def sizes(recipe):
    """Keys of the lengths and positions of a recipe's mechanism, each with the key of its field."""
    numbers = [n for n in numbers_in(recipe) if n.unit == "mm"]
    numbers = [n for n in numbers if not any(word in n.key for word in NO_SIZES)]
    # A point at the origin of a body's frame says where the frame is, and another point how long the body is.
    zero = {n.field for n in numbers if ".bodies." in n.key or n.key.endswith("].point[0]")}
    zero -= {n.field for n in numbers if n.value}
    return {n.key: n.field for n in numbers if n.field not in zero and not n.key.endswith("].point[1]")}


@pytest.mark.campaign
def test_nine_in_ten_lengths_and_positions_have_a_handle():
    reached = total = 0
    for path in RECIPES:
        recipe = gk.load(path)
        keys = {key for handle in recipe.handles for key in handle.keys}
        known = sizes(recipe)
        assert keys <= {name for n in numbers_in(recipe) for name in (n.key, n.field)}, path.stem
        assert len({handle.id for handle in recipe.handles}) == len(recipe.handles), path.stem
        total += len(known)
        reached += sum(not keys.isdisjoint(pair) for pair in known.items())
    assert reached / total >= LEAST_SHARE, f"{reached} of {total}"


def after(stem, id, to, changes=(), frame=0, step=0.1, **more):
    """The recipe, and the values that its text states, after a drag of one handle of a gallery recipe."""
    text = Path(f"recipes/{stem}.toml").read_text()
    if changes:
        text = answer(text, {}, {"set": dict(changes)})["text"]
    drag = {"handle": id, "to": [to.real, to.imag], "frame": frame, "step": step, **more}
    reply = answer(text, {}, {"drag": drag})
    assert not reply["problems"]
    return gk.load(reply["text"]), tomllib.loads(reply["text"]), reply


def test_a_circle_goes_through_the_pointer():
    recipe, _, _ = after("roller-cam", "circle:cam.base_radius", 20 + 40j)
    assert recipe.cam.base_radius == pytest.approx(abs(20 + 40j), abs=0.1)
    recipe, _, _ = after("rocker-cam", "circle:cam.follower.roller_radius", 30 + 50j, frame=7)
    contact = recipe.cam.contact(recipe.drive.angles[7:8])
    centre = contact.point + recipe.cam.follower.roller_radius * contact.normal
    assert abs(centre[0] - (30 + 50j)) == pytest.approx(recipe.cam.follower.roller_radius, abs=0.1)


def test_the_end_of_a_rise_is_dragged_on_the_plot_of_the_lift():
    recipe, text, _ = after("roller-cam", "plot:cam.program[1].end_deg", 170 + 24j, step=[0.5, 0.1])
    assert text["cam"]["program"][1] | {"law": ""} == {"kind": "rise", "law": "", "rise": 24, "end_deg": 170}
    lift = recipe.cam.program.motion(np.radians([169.999, 200])).lift
    assert lift == pytest.approx([24, 24], abs=1e-3)
    # The dwell after it begins at 180 deg, and the next segment ends at 270 deg.
    _, text, reply = after("roller-cam", "plot:cam.program[1].end_deg", 300 + 24j, step=[0.5, 0.1])
    assert text["cam"]["program"][1]["end_deg"] < 270 and reply["limit"]


def test_teeth_change_in_whole_steps_and_modules_together():
    recipe, text, _ = after("gear-pair", "circle:second.teeth", 0 + 100j)
    assert isinstance(text["second"]["teeth"], int) and text["second"]["teeth"] > 24
    recipe, text, _ = after("gear-pair", "circle:first.module", 20 + 0j)
    assert text["first"]["module"] == text["second"]["module"] == recipe.design.module
    assert recipe.design.first.root_radius == pytest.approx(20, abs=0.1)


@pytest.mark.parametrize(("given", "to"), [((), 57j), ([("centre_distance", 58.0)], 58.5j)])
def test_the_axis_of_a_gear_is_dragged(given, to):
    recipe, text, _ = after("gear-pair", "point:centre_distance" if given else "point:first.profile_shift", to, given)
    assert recipe.design.centre_distance == pytest.approx(to.imag, abs=0.1)
    assert (text["first"]["profile_shift"] == 0.6) == bool(given)


def test_poses_points_and_regions_follow_without_a_search():
    text = Path("recipes/three-poses.toml").read_text()
    recipe = gk.load(text)
    handles = {handle.id: handle for handle in recipe.handles}
    turn = complex(handles["point:wanted.poses[1][2]"].at[0]) - complex(handles["point:wanted.poses[1][0]"].at[0])
    assert np.angle(turn, deg=True) == pytest.approx(35)
    _, values, _ = after("three-poses", "point:wanted.poses[1][2]", -20 + 60j + 40j)
    assert values["wanted"]["poses"][1] == [-20, 60, pytest.approx(90, abs=0.5)]
    _, values, _ = after("three-poses", "point:wanted.poses[1][0]", -25 + 66j)
    assert values["wanted"]["poses"][1] == [-25, 66, 35]
    _, values, _ = after("three-poses", "point:wanted.region[1]", 70 + 130j)
    assert values["wanted"]["region"] == [[-160, -60], [70, 130]]
    assert "ranked" not in vars(recipe) and "found" not in vars(recipe)


def test_a_force_turns_with_its_handle_and_grows_with_its_distance():
    recipe = gk.load("recipes/loaded-crank-rocker.toml")
    id, pin = "point:loads.forces[0].force_n", recipe.motion.point("rocker_pin").position[20]
    handle = next(handle for handle in recipe.handles if handle.id == id)
    arrow = complex(handle.at[20] - pin)
    assert np.angle(arrow, deg=True) == pytest.approx(-90) and handle.arrow == pytest.approx(arrow)
    # A force along x of the same size, then one twice as far away, whose logarithm is twice as large.
    for factor, size in ((1, 25), (2, np.sinh(2 * np.arcsinh(25)))):
        _, values, _ = after("loaded-crank-rocker", id, complex(pin + factor * abs(arrow)), frame=20, step=0.01)
        x, y = values["loads"]["forces"][0]["force_n"]
        assert x == pytest.approx(size, rel=0.01) and abs(y) < 0.01 * size


def test_the_grid_of_an_atlas_moves_with_the_coupler():
    recipe, _, _ = after("coupler-atlas", "point:grid.length", 60 + 120j, frame=10)
    coupler = recipe.motion.bodies["coupler"]
    corners = [coupler.point(complex(z)).position[10] for z in recipe.grid.points[[0, -1]].ravel()]
    assert np.abs(np.array(corners) - (60 + 120j)).min() < 0.15


def test_a_drag_to_a_limit_gives_a_round_number_inside_it():
    _, text, reply = after("spur-gear", "circle:gear.profile_shift", 60 + 0j)
    shift = text["gear"]["profile_shift"]
    assert reply["limit"] and len(str(shift)) <= 5 and 1.3 < shift < 1.4


def test_a_coupler_point_that_is_not_given_is_drawn_out_of_its_pin():
    text = 'kind = "four-bar"\n[linkage]\nground = 100\ncrank = 30\ncoupler = 90\nrocker = 70\n'
    handle = next(handle for handle in gk.load(text).handles if handle.id == "point:coupler_point")
    to = complex(handle.at[5]) + 4 - 2j
    drag = {"handle": handle.id, "to": [to.real, to.imag], "frame": 5, "step": 0.1}
    recipe = gk.load(answer(text, {}, {"drag": drag})["text"])
    assert abs(recipe.motion.point("coupler_point").position[5] - to) < 0.15
