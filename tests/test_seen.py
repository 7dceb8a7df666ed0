"""The README's table of what can be seen: each thing has its row, and what a row promises is on one of its pages."""

import re
from functools import cache
from pathlib import Path

import pytest

import geomkin as gk
from geomkin.export.job import Job
from geomkin.export.sections import checks, notes

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")
TABLE = README.split("| what | recipes | on the page |\n|---|---|---|\n")[1].split("\n\n")[0]
ROWS = [[cell.strip() for cell in line.strip("|").split("|")] for line in TABLE.splitlines()]
# All that a page is to show, in the order of the table.
WHAT = [
    "Four-bar analysis",
    "Slider-crank analysis",
    "Inversions of the slider-crank",
    "Six-bars",
    "Any linkage of bodies and pins",
    "Velocity and acceleration polygons, instant centres",
    "Coupler-curve atlas",
    "Cognates",
    "Centrodes",
    "Inflection circle and path curvature",
    "Shaking force",
    "Trammel, Scotch yoke, Oldham coupling",
    "Crank-rocker design",
    "Double-rocker design",
    "Function generation",
    "Body guidance, three poses",
    "Body guidance, four and five poses",
    "Path generation",
    "Cam design",
    "Motion plots",
    "Least peak acceleration",
    "Cam profile",
    "Cam and follower in contact",
    "Involute gears and the tool that cuts them",
    "Mates of any tooth",
    "Gears in mesh",
]
SWITCHES = dict(re.findall(r'(\w+): "([\w ]+)"', re.search(r"const ROLES = {(.*?)}", "".join(
    file.read_text("utf-8") for file in sorted((ROOT / "geomkin" / "web").glob("*.js"))
), flags=re.DOTALL)[1]))  # fmt: skip


@cache
def told(name):
    """What stands on a recipe's page, as it is called there: plots, curves, marks, switches, checks, what is known."""
    recipe = gk.load(ROOT / "recipes" / f"{name}.toml")
    scene = recipe.scene
    things = (*scene.curves, *scene.marks, *scene.regions)
    labels = {thing.label for thing in things}
    # A label's own words stand before the colon that explains it.
    labels |= {label.split(":")[0] for label in labels} | {plot.title for plot in scene.plots}
    labels |= {SWITCHES[thing.role] for thing in things}
    labels |= {plot.title for plot in scene.choice.plots} if scene.choice else set()
    page = checks(Job(name, recipe, 0.01)) + notes(recipe.notes)
    labels |= set(re.findall(r"<(?:h3|dt|th[^>]*)>(.*?)</(?:h3|dt|th)>", page))
    return labels | ({"others beside"} if scene.others else set())


def test_each_thing_has_its_row_and_each_row_recipes_of_the_gallery():
    assert [row[0] for row in ROWS] == WHAT
    for _, recipes, where in ROWS:
        assert all((ROOT / "recipes" / f"{name}.toml").exists() for name in recipes.split(", ")) and "`" in where


@pytest.mark.campaign
@pytest.mark.parametrize("row", ROWS, ids=WHAT)
def test_what_a_row_promises_is_on_its_pages(row):
    found = set().union(*(told(name) for name in row[1].split(", ")))
    promised = re.findall(r"`([^`]+)`", row[2])
    assert promised and not set(promised) - found, sorted(found)
