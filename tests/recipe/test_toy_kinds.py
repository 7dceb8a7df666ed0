"""A kind, a goal and a scene added from outside, through the public contracts alone.

A goal takes a file for its search, one for its class, a row, a recipe and a test; a kind's scene one property.
"""

import json
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
import pytest

import geomkin as gk
from geomkin.core.fields import check_sizes, entry, quantity
from geomkin.export import WRITERS, Job, Writer
from geomkin.model.scene import Scene, SceneBody
from geomkin.recipe import AbstractGoal, AbstractRecipe, Files
from geomkin.recipe.kinds import KINDS, KindRow
from tests.texts import parse, template_of

# What has been worked out, in order.
ASKED: list[str] = []


@dataclass(frozen=True)
class Washer:
    """A ring that turns."""

    radius: float = quantity("outer radius", "mm", above=0, at_most=1000, example=20)
    hole: float = quantity("diameter of the hole", "mm", default=5.0, above=0, at_most=1000)

    def __post_init__(self) -> None:
        check_sizes(self)
        if self.hole >= 2 * self.radius:
            raise gk.DesignError("hole", f"found {self.hole:g} mm", "give less than the washer")


@dataclass(frozen=True, kw_only=True)
class WasherRecipe(AbstractRecipe):
    """A washer, which is no more than a toy."""

    kind: Literal["washer"] = "washer"
    washer: Washer
    thickness: float = quantity("of the sheet", "mm", default=2.0, above=0, at_most=100)
    files: Files = entry("what is written", default=Files())

    @property
    def design(self) -> Washer:
        return self.washer

    @cached_property
    def table(self) -> gk.Table:
        ASKED.append("table")
        turn = np.linspace(0, 360, 5)
        return gk.Table((gk.Column("turn", "deg", "how far it has turned", turn),))

    @cached_property
    def parts(self) -> tuple[gk.Part, ...]:
        ASKED.append("parts")
        hole = gk.plane.Circle(0, self.washer.hole / 2)
        return (gk.Part("washer", gk.plane.Circle(0, self.washer.radius), (hole,), self.thickness),)

    @property
    def design_checks(self) -> tuple[gk.Check, ...]:
        return (gk.Check("washer_s_radius", "washer's radius", self.washer.radius, "at least", 10.0, "mm"),)

    @cached_property
    def scene(self) -> Scene:
        ASKED.append("scene")
        turn = np.radians(self.table["turn"])
        body = SceneBody("washer", self.parts, np.zeros(5, dtype=complex), np.exp(1j * turn))
        return Scene(self.table, turn, np.full(5, True), (body,))


@dataclass(frozen=True, kw_only=True)
class StillRecipe(WasherRecipe):
    """A washer that shows nothing."""

    kind: Literal["still"] = "still"
    scene = None


@dataclass(frozen=True, kw_only=True)
class RockerSwingRecipe(AbstractGoal):
    """The crank-rocker whose rocker swings by a wanted angle."""

    kind: Literal["rocker-swing"] = "rocker-swing"
    swing_deg: float = quantity("how far the rocker swings", "deg", above=0, at_most=60, example=40)
    files: Files = entry("what is written", default=Files())

    @cached_property
    def design(self) -> AbstractRecipe:
        low, high = 0.0, 40.0
        for _ in range(60):
            crank = (low + high) / 2
            low, high = (low, crank) if swing_of(crank) > np.radians(self.swing_deg) else (crank, high)
        return gk.linkage.FourBarRecipe(linkage=gk.FourBar(100, crank, 90, 70), files=self.files)

    @property
    def design_checks(self) -> tuple[gk.Check, ...]:
        off = np.degrees(swing_of(self.design.linkage.crank)) - self.swing_deg
        return (gk.Check("missed_swing", "missed swing", abs(off), "at most", 1e-9, "deg"), *super().design_checks)

    @property
    def notes(self) -> dict[str, object]:
        return {"found": {"crank": self.design.linkage.crank}, **super().notes}


def swing_of(crank):
    """Between the dead centres, where crank and coupler of the four-bar 100, crank, 90, 70 are in line."""
    return np.diff([np.arccos((100**2 + 70**2 - reach**2) / (2 * 100 * 70)) for reach in (90 - crank, 90 + crank)])[0]


def shown(job: Job) -> dict[str, bytes]:
    """A toy player: the scene as text."""
    data = {"bodies": [body.name for body in job.scene.bodies], "frames": len(job.scene.time)}
    return {f"{job.name}.show": json.dumps(data).encode()}


@pytest.fixture(autouse=True)
def toys(monkeypatch):
    for recipe in (WasherRecipe, StillRecipe, RockerSwingRecipe):
        monkeypatch.setitem(KINDS, recipe.kind, KindRow("toys", f"{recipe.__module__}:{recipe.__name__}"))
    monkeypatch.setitem(WRITERS, "show", Writer("scene", shown))
    ASKED.clear()


@pytest.mark.parametrize(
    ("write", "only", "asked"),
    [
        (("dxf",), None, {"parts"}),
        (("dxf", "csv", "show"), ["dxf"], {"parts"}),
        (("svg", "stl"), None, {"parts"}),
        (("csv",), None, {"parts", "table"}),
        (("show", "dxf"), ["show"], {"parts", "table", "scene"}),
    ],
)
def test_nothing_is_worked_out_that_no_format_asks_for(tmp_path, write, only, asked):
    """The checks ask for the parts, whose walls they judge; all else is for the formats."""
    recipe = WasherRecipe(washer=Washer(20), files=Files(write=write))
    gk.make(recipe, tmp_path, only)
    assert sorted(ASKED) == sorted(asked)


def test_goal_passes_on_the_properties_of_its_found_recipe(tmp_path):
    goal = gk.load('kind = "rocker-swing"\nswing_deg = 40\n')
    found = goal.design
    assert found.table is goal.table and found.parts is goal.parts and found.scene is goal.scene
    assert found == gk.linkage.FourBarRecipe(linkage=gk.FourBar(100, found.linkage.crank, 90, 70))
    assert [c.name for c in goal.checks] == ["missed swing", *(c.name for c in found.checks)]
    # By another road: the rocker's angle over a turn of the crank.
    turns = np.linspace(0, 2 * np.pi, 7201)
    rocker = np.angle(gk.move(found.linkage, turns).rocker.direction)
    assert np.degrees(np.ptp(rocker)) == pytest.approx(40, abs=1e-4)
    made = gk.make(goal, tmp_path)
    data = json.loads((tmp_path / "rocker-swing" / "summary.json").read_text())
    assert data["found"] == {"crank": found.linkage.crank} and data["stack"] and data["recipe"]["swing_deg"] == 40
    assert {"rocker-swing.csv", "crank.stl"} <= {p.name for p in made.files}
    assert parse(template_of("rocker-swing")) == goal
    assert repr(goal).startswith("RockerSwingRecipe(") and "swing_deg=40" in repr(goal)
