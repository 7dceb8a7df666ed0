"""Columns, checks, plots, roles and refusals are referred to by ids."""

import json
import re
from pathlib import Path
from typing import get_args

import numpy as np
import pytest

import geomkin as gk
from geomkin.model.scene import ROLES, Limit, Plot, Role
from geomkin.page.page import scene_json
from geomkin.page.sections import worst_frame

RECIPES = Path(__file__).parent.parent.parent / "recipes"
GIVEN = [
    "crank-rocker",
    "roller-cam",
    "spur-gear",
    "gear-pair",
    "rack-and-pinion",
    "planetary",
    "point-tooth",
    "walker",
]
# Of kinds whose scenes go by other columns than their tables.
MOVING = ["crank-rocker", "roller-cam", "undercut-cam", "watt-six-bar", "inflection-circle", "shaking-force"]


@pytest.fixture(scope="module")
def recipes():
    return {name: gk.load(RECIPES / f"{name}.toml") for name in {*GIVEN, *MOVING}}


@pytest.mark.parametrize("name", GIVEN)
def test_ids_are_in_snake_case_and_differ(recipes, name):
    recipe = recipes[name]
    for ids in (recipe.table.ids, [check.id for check in recipe.checks]):
        assert len(set(ids)) == len(ids)
        assert all(re.fullmatch(r"[A-Za-z0-9_]+|wall_.+", id) for id in ids), ids


def test_a_column_is_found_by_its_id_and_by_its_header(recipes):
    table = recipes["crank-rocker"].table
    for column in table.columns:
        assert table.column(column.id) is table.column(column.header) is column
        assert table[column.id] is table[column.header] is column.values
    with pytest.raises(gk.DesignError) as refusal:
        table["rocker_omge"]
    assert (refusal.value.field, refusal.value.id) == ("id", "unknown-key") and "rocker_omega" in refusal.value.remedy


@pytest.mark.parametrize(("unit", "twin"), [("mm", "a"), ("deg", "a"), ("", "a_mm")])
def test_neither_two_ids_nor_two_headers_of_a_table_agree(unit, twin):
    with pytest.raises(gk.DesignError) as refusal:
        gk.Table((gk.Column("a", "mm", "", np.ones(2)), gk.Column(twin, unit, "", np.ones(2))))
    assert refusal.value.id == "conflict"


@pytest.mark.parametrize("name", MOVING)
def test_a_check_names_a_column_and_is_worst_within_the_driver_s_range(recipes, name):
    recipe = recipes[name]
    drive = recipe.scene.drive.values
    placed = [check for check in recipe.checks if check.at is not None]
    assert placed
    for check in recipe.checks:
        assert check.column == "" or check.column in recipe.table.ids, check.id
    for check in placed:
        assert drive.min() - 1e-9 <= check.at <= drive.max() + 1e-9, check.id


def test_the_worst_place_is_where_the_column_has_the_value(recipes):
    for name, id in (
        ("crank-rocker", "transmission_angle"),
        ("roller-cam", "pressure_angle_rise"),
        ("roller-cam", "pressure_angle_return"),
        ("undercut-cam", "lost_lift"),
    ):
        recipe = recipes[name]
        check = next(check for check in recipe.checks if check.id == id)
        drive, values = recipe.table.columns[0].values, np.abs(recipe.table[check.column])
        assert np.interp(check.at, drive, values) == pytest.approx(check.value, rel=0.01), id


def test_rise_and_return_of_a_cam_have_frames_of_their_own(recipes):
    recipe = recipes["roller-cam"]
    frames = {check.id: worst_frame(check, recipe.scene) for check in recipe.checks}
    rise, back = frames["pressure_angle_rise"], frames["pressure_angle_return"]
    lift = recipe.table["lift"]
    assert lift[rise - 1] < lift[rise + 1] and lift[back - 1] > lift[back + 1]
    assert frames["wall_cam"] is None


def test_an_unreachable_range_is_worst_where_it_is_left_first():
    recipe = gk.load("kind = 'four-bar'\n[linkage]\nground = 100\ncrank = 80\ncoupler = 60\nrocker = 50\n")
    check = next(check for check in recipe.checks if check.id == "share_reached")
    # Cosine rule at the crank's pivot, coupler and rocker in line.
    limit = np.degrees(np.arccos((100**2 + 80**2 - (60 + 50) ** 2) / (2 * 100 * 80)))
    assert check.at == pytest.approx(limit) and not check.passed
    nearest = int(np.argmin(np.abs(np.degrees(recipe.motion.drive) - limit)))
    assert worst_frame(check, recipe.scene) == nearest


@pytest.mark.campaign
def test_the_largest_output_error_is_at_its_peak():
    recipe = gk.load(RECIPES / "log-generator.toml")
    check = next(check for check in recipe.checks if check.id == "output_error")
    frame = worst_frame(check, recipe.scene)
    assert check.column == "error" and abs(recipe.table["error"][frame]) == pytest.approx(check.value, rel=0.02)


def test_plots_and_limits_refer_to_columns_of_the_table(recipes):
    scene = recipes["crank-rocker"].scene
    for plot in scene.plots:
        assert set(plot.columns) <= set(scene.table.ids)
        assert {limit.column for limit in plot.limits} <= set(plot.columns)
    limited = [("transmission_angle",), ("rocker_mechanical_advantage",)]
    assert [plot.columns for plot in scene.plots if plot.limits] == limited
    plot = Plot("both", ("a", "b")).with_limits([Limit("b", 1.0, "at most"), Limit("c", 2.0, "at most")])
    assert [limit.column for limit in plot.limits] == ["b"]


def test_roles_have_one_home_that_pages_are_given():
    assert set(ROLES) == set(get_args(Role))
    scene = gk.load(RECIPES / "crank-rocker.toml").scene
    roles = {role["id"]: role for role in json.loads(scene_json(scene, "a"))["roles"]}
    used = {item.role for item in (*scene.marks, *scene.curves)}
    assert set(roles) == used and [role for role in ROLES if role in used] == list(roles)
    assert all((role["label"], role["shown"], role["room"]) == ROLES[id] for id, role in roles.items())


@pytest.mark.parametrize(
    ("text", "key", "id"),
    [
        ("kind = 'spur-gaer'\n", "kind", "unknown-kind"),
        ("[gear]\nteeth = 20\n", "kind", "missing-key"),
        ("kind = 'spur-gear'\n[gear]\nteeth = 20\n", "gear.module", "missing-key"),
        ("kind = 'spur-gear'\n[gear]\nteeth = 20\nmodule = 2\nodd = 3\n", "gear.odd", "unknown-key"),
        ("kind = 'spur-gear'\n[gear]\nteeth = 20.5\nmodule = 2\n", "gear.teeth", "wrong-type"),
        ("kind = 'spur-gear'\n[gear]\nteeth = 20\nmodule = -2\n", "gear.module", "out-of-range"),
        ("kind = 'spur-gear'\n[gear]\nteeth = 20\nmodule = nan\n", "gear.module", "not-finite"),
        ("kind = 'spur-gear'\n[gear]\nteeth = 20\nmodule = 2 mm\n", "gear.module", "invalid-toml"),
        ("kind = 'spur-gear\n", "", "invalid-toml"),
        (
            "kind = 'four-bar'\nlinkage = { ground = 80, crank = 30, coupler = 70, rocker = 60 }\n"
            "drive = { step_deg = 0.001, end_deg = 3600 }\n",
            "drive.step_deg",
            "too-much-work",
        ),
    ],
)
def test_each_problem_of_a_recipe_has_the_id_of_its_kind(text, key, id, tmp_path):
    with pytest.raises(gk.RecipeError) as refusal:
        gk.make(text, tmp_path)
    assert (key, id) in [(problem.key, problem.id) for problem in refusal.value.problems]


@pytest.mark.parametrize(
    ("call", "id"),
    [
        (lambda: gk.SpurGear("20", 2), "wrong-type"),
        (lambda: gk.SpurGear(20, -2), "out-of-range"),
        (lambda: gk.SpurGear(20, float("inf")), "not-finite"),
        (lambda: gk.plane.Circle("0", 1.0), "wrong-type"),
        (lambda: gk.plane.Circle(0j, float("nan")), "not-finite"),
        (lambda: gk.plane.Circle(0j, -1.0), "out-of-range"),
    ],
)
def test_a_refused_argument_has_the_id_of_its_kind(call, id):
    with pytest.raises(gk.DesignError) as refusal:
        call()
    assert refusal.value.id == id
