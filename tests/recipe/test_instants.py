"""Inflection circles and centrodes of any body of any linkage."""

import dataclasses
import tomllib
from pathlib import Path

import numpy as np
import pytest

import geomkin as gk
from geomkin.linkage import inflection_circle
from geomkin.linkage.kinds.instants import PLAIN, CentrodesRecipe, InflectionCircleRecipe
from geomkin.recipe import to_toml
from tests.campaign import by_default
from tests.texts import parse, template_of

GALLERY = Path(__file__).parents[2] / "recipes"
SLIDER_CRANK = """
kind = "inflection-circle"
position_deg = 40
[linkage]
kind = "slider-crank"
crank = 30
coupler = 90
offset = 8
coupler_point = [35, 20]
"""


def seen_curvature(linkage: gk.linkage.AbstractLinkage, body: str, local: complex, drive: float) -> float:
    """Of a path, by central differences of its points."""
    h = 1e-3
    z = gk.move(linkage, drive + h * np.arange(-2, 3)).bodies[body].point(local).position
    first = (z[0] - 8 * z[1] + 8 * z[3] - z[4]) / (12 * h)
    second = (-z[0] + 16 * z[1] - 30 * z[2] + 16 * z[3] - z[4]) / (12 * h * h)
    return float((np.conj(first) * second).imag / abs(first) ** 3)


@pytest.mark.parametrize("kind", by_default(PLAIN, slice(0, None, 2)))
@pytest.mark.parametrize("recipe", ["inflection-circle", "centrodes"])
def test_any_linkage_is_read_written_and_drawn(recipe: str, kind: str) -> None:
    found = parse(template_of(recipe, [f"linkage={kind}"]))
    assert type(found.linkage) is PLAIN[kind]
    assert parse(to_toml(found)) == found
    assert np.isfinite(found.table.columns[2].values).any()
    assert all(check.passed for check in found.checks) and found.scene is not None


def test_curvature_is_that_of_the_path_seen() -> None:
    recipe = parse(SLIDER_CRANK)
    reported = recipe.table
    for frame in (17, 200):
        seen = seen_curvature(recipe.linkage, "coupler", 35 + 20j, np.radians(frame))
        assert reported["path_curvature"][frame] == pytest.approx(seen, rel=1e-6)
    other = dataclasses.replace(recipe, point=60 - 15j)
    seen = seen_curvature(recipe.linkage, "coupler", 60 - 15j, np.radians(200))
    assert other.table["path_curvature"][200] == pytest.approx(seen, rel=1e-6)


@pytest.mark.parametrize(
    ("linkage", "body"),
    [
        (gk.SliderCrank(30, 90, 8), "coupler"),
        (gk.StephensonSixBar(gk.FourBar(99, 30, 77, 95, 128 + 15j), 58.7, 60, 69 + 191j), "link"),
        (gk.WattSixBar(gk.FourBar(100, 30, 90, 70), 50 - 30j, 90, 60, 180 + 0j), "link"),
    ],
)
def test_points_on_the_circle_go_straight(linkage: gk.linkage.AbstractLinkage, body: str) -> None:
    drive = np.radians(40)
    recipe = InflectionCircleRecipe(linkage=linkage, body=body, position_deg=40)
    row = {c.id: c.values[40] for c in recipe.table.columns}
    pole = row["inflection_pole_x"] + 1j * row["inflection_pole_y"]
    middle = (pole + row["instant_centre_x"] + 1j * row["instant_centre_y"]) / 2
    pose = gk.move(linkage, [drive]).bodies[body]
    for turn in (0.4, 2.0, 2.9):
        place = middle + (pole - middle) * np.exp(1j * turn)
        local = complex((place - pose.origin.position[0]) * np.conj(pose.direction[0]))
        assert abs(seen_curvature(linkage, body, local, drive)) * row["inflection_diameter"] < 1e-3
    assert recipe.parts


def test_centrodes_of_a_trammel_are_cardan_s_circles() -> None:
    recipe = CentrodesRecipe(linkage=gk.EllipticTrammel(60), body="rod")
    fixed, moving = (curves[0].point(np.linspace(0.1, 6, 50)) for curves in recipe.curves)
    np.testing.assert_allclose(abs(fixed), 60, rtol=1e-12)
    np.testing.assert_allclose(abs(moving - 30), 30, rtol=1e-12)


def test_a_slide_drives_to_the_same_circle() -> None:
    turned = gk.SliderCrank(30, 90, 8, 35 + 20j)
    at = float(gk.move(turned, [0.7]).bodies["slider"].origin.position[0].real)
    slid = dataclasses.replace(turned, driver="slider")
    # The crank pin left of the line from crank pivot to slider pin, as at 0.7 rad.
    recipe = InflectionCircleRecipe(linkage=slid, stroke=gk.recipe.Stroke(start=90, end=115), position_mm=at)
    found = inflection_circle(recipe.position, "coupler")
    same = inflection_circle(gk.move(turned, [0.7]), "coupler")
    assert found.diameter[-1] == pytest.approx(same.diameter[0], rel=1e-9)
    assert found.pole[-1] == pytest.approx(same.pole[0], rel=1e-9)
    assert recipe.drive_column.unit == "mm" and recipe.parts and recipe.scene is not None


def test_loops_and_followed_branches_come_to_the_position_from_the_table_s_first_frame() -> None:
    sieve = tomllib.loads((GALLERY / "sieve.toml").read_text())["linkage"]
    loops = {"body": "sieve", "linkage": {**sieve, "kind": "linkage"}}
    platform = {"branch": "follow", "linkage": {"ground": 100, "crank": 30, "coupler": 100, "rocker": 30}}
    for changes in (loops, platform):
        recipe = gk.load({"kind": "inflection-circle", "position_deg": 200, **changes})
        place = recipe.position.bodies[recipe.body].point(recipe.local).position[0]
        assert place == pytest.approx(recipe.motion.bodies[recipe.body].point(recipe.local).position[200], abs=1e-9)
        (part,) = recipe.parts
        paths = [mark for mark in part.marks if isinstance(mark, gk.CouplerCurve)]
        assert [abs(path.point(recipe.place) - place) < 1e-9 for path in paths] == [True]
