"""The Pareto front of several objectives, against grids of all designs."""

import csv

import numpy as np
import pytest
from click.testing import CliRunner

import geomkin as gk
from geomkin.cli import cli
from geomkin.optimisation.search import even_shares
from tests.optimisation.test_independent_optima import STEP_DEG, four_bar

FOUR_BAR = {
    "kind": "four-bar",
    "linkage": {"ground": 100, "crank": 30, "coupler": 90, "rocker": 70},
    "drive": {"step_deg": STEP_DEG},
}
GEAR = {"kind": "spur-gear", "gear": {"teeth": 24, "module": 2, "profile_shift": 0.0}}
TEETH = {"gear.teeth": (8, 20)}


def dominates(results, others):
    """Whether each row of `results` is at least as good as each of `others` in all columns and better in one."""
    pairs = results[:, None], others[None]
    return (pairs[0] <= pairs[1]).all(axis=-1) & (pairs[0] < pairs[1]).any(axis=-1)


@pytest.mark.campaign
def test_front_of_transmission_angle_and_swing_agrees_with_a_grid():
    vary = {"linkage.coupler": (60, 120), "linkage.rocker": (50, 100)}
    # Nearer to the edge of assembly a search may miss designs.
    limit = "min(transmission_angle) >= 15"
    front = gk.optimise(FOUR_BAR, vary, ["-min(transmission_angle)", "-range(rocker_angle)"], limit, starts=1)
    found = np.array([design.objectives for design in front.designs])
    assert 10 < len(found) <= 21 and (np.diff(found[:, 0]) > 0).all() and (np.diff(found[:, 1]) < 0).all()
    coupler, rocker = (axis.ravel() for axis in np.meshgrid(np.linspace(60, 120, 241), np.linspace(50, 100, 201)))
    with np.errstate(all="ignore"):
        results = four_bar(coupler=coupler, rocker=rocker)
    grid = -np.stack([results["transmission_angle"].min(axis=0), np.ptp(results["rocker_angle"], axis=0)], axis=1)
    grid = grid[np.isfinite(grid).all(axis=1) & (grid[:, 0] <= -15)]
    assert not dominates(grid, found - 1e-4).any()
    # Wherever the grid is, a design of the front is nearly as good: within one of its twenty steps and one of the grid.
    size = np.ptp(found, axis=0)
    behind = ((found[:, None] - grid[None]) / size).max(axis=-1).min(axis=0)
    assert behind.max() < 1 / 20 + 0.01
    for design, objectives in zip(front.designs, found):
        table = design.recipe.table
        assert -table["transmission_angle"].min() == pytest.approx(objectives[0])
        assert -np.ptp(table["rocker_angle"]) == pytest.approx(objectives[1])


@pytest.mark.parametrize("names", [("rim", "tip_thickness"), ("rim", "tip_thickness", "undercut")])
def test_front_of_whole_numbers_is_that_of_the_sweep(names):
    sweep = gk.sweep(GEAR, {"gear.teeth": "8:20:1"})
    teeth = [row.values["gear.teeth"] for row in sweep.rows]
    checks = [{check.id: check.value for check in row.checks} for row in sweep.rows]
    results = np.array([[check["rim"], -check["tip_thickness"], check["undercut"]] for check in checks])
    allowed = results[:, 2] < 1
    results = results[:, : len(names)]
    best = allowed & ~dominates(results[allowed], results).any(axis=0)
    formulas = ["rim", "-tip_thickness", "undercut"][: len(names)]
    front = gk.optimise(GEAR, TEETH, formulas, "undercut <= 0.999999")
    assert sum(best) > 2
    assert {design.values["gear.teeth"] for design in front.designs} == {n for n, on in zip(teeth, best) if on}


def test_directions_of_the_search_are_even_and_bounded():
    for count in (2, 3, 4):
        shares = np.array(list(even_shares(count)))
        assert shares.sum(axis=1) == pytest.approx(1) and shares.min() == 0 and shares.max() == 1
        assert 20 <= len(shares) <= 21 and len(np.unique(shares, axis=0)) == len(shares)


@pytest.mark.campaign
def test_command_writes_table_picture_and_recipes_of_the_front(tmp_path):
    table = {"vary": ["gear.teeth = 8:20"], "minimise": ["rim", "-tip_thickness"], "subject_to": ["undercut <= 0"]}
    (tmp_path / "wheel.toml").write_text(gk.recipe.to_toml(gk.load({**GEAR, "optimise": table})))
    folder = tmp_path / "wheel"
    folder.mkdir()
    for stale in ("wheel.front-99.toml", "wheel.front-mine.txt"):
        (folder / stale).write_text("")
    result = CliRunner().invoke(cli, ["optimise", str(tmp_path / "wheel.toml"), "--out", str(tmp_path)])
    assert result.exit_code == 0, result.output
    front = gk.optimise(tmp_path / "wheel.toml")
    rows = list(csv.reader((folder / "wheel.front.csv").read_text().splitlines()))
    numbers = np.array(rows[1:], dtype=float)
    assert numbers[:, 1:3] == pytest.approx(np.array([design.objectives for design in front.designs]), rel=1e-9)
    assert len(result.output.splitlines()) == len(rows) + 1
    for number, _, _, teeth in numbers:
        assert gk.load(folder / f"wheel.front-{number:.0f}.toml").gear.teeth == teeth
    names = {"wheel.front.csv", "wheel.front.svg", "wheel.front.html", "wheel.front-mine.txt"}
    assert {path.name for path in folder.iterdir()} == names | {f"wheel.front-{k}.toml" for k in range(1, len(rows))}
    # One dot for each design.
    picture = (folder / "wheel.front.svg").read_text()
    dots = picture.split('stroke-linecap="round"')[0].rpartition("<path")[2]
    assert dots.count("M") == len(front.designs) > 2


@pytest.mark.parametrize("formulas", [[], ["rim"], ["rim", " rim"], [f"rim + {k}" for k in range(5)], ["rim", "krim"]])
def test_wrong_numbers_of_objectives_are_refused(formulas):
    with pytest.raises(gk.DesignError) as refused:
        gk.optimise(GEAR, TEETH, formulas)
    assert refused.value.field == "minimise"


def test_a_front_within_constraints_that_nothing_meets_names_them():
    with pytest.raises(gk.DesignError) as refused:
        gk.optimise(GEAR, TEETH, ["rim", "-tip_thickness"], "undercut <= -1")
    assert refused.value.field == "subject_to" and "undercut" in str(refused.value)


@pytest.mark.campaign
def test_time_limit_ends_the_search_of_a_front():
    front = gk.optimise(
        FOUR_BAR, {"linkage.coupler": (60, 120)}, ["max(rocker_omega)", "-range(rocker_angle)"], time_limit=0.3
    )
    assert front.cut_short and len(front.designs) >= 1
