"""The key `effective_components`: columns, plots, arrows and a check, only where they are requested."""

import numpy as np
import pytest

import geomkin as gk

BARS = {"ground": 100, "crank": 30, "coupler": 90, "rocker": 70}
DRIVE = {"step_deg": 10, "speed_rpm": 60}


def four_bar(**more):
    return gk.load({"kind": "four-bar", "linkage": BARS, "drive": DRIVE, **more})


def test_columns_plots_arrows_and_check_come_with_the_key_alone():
    plain, recipe = four_bar(), four_bar(effective_components=True)
    added = [id for id in recipe.table.ids if id not in plain.table.ids]
    assert plain.table.ids == recipe.table.ids[: len(plain.table.ids)] and added
    assert recipe.table["rocker_pin_velocity_along_coupler"] == pytest.approx(
        recipe.table["crank_pin_velocity_along_coupler"], rel=1e-9
    )
    assert [check.id for check in recipe.checks if check not in plain.checks] == ["effective_components"]
    assert all(check.passed for check in recipe.checks if check.id == "effective_components")
    plotted = {id for plot in recipe.scene.plots for id in plot.columns}
    assert set(added) <= plotted
    arrows = [len([m for m in r.scene.marks if m.sort == "vector"]) for r in (plain, recipe)]
    assert arrows[1] - arrows[0] == len(added)


def test_arrows_of_the_components_add_up_to_the_vector_of_the_pin():
    marks = [m for m in four_bar(effective_components=True).scene.marks if m.sort == "vector" and m.role == "velocity"]
    pin = marks[0].place
    here = [m.vector for m in marks if np.array_equal(m.place, pin)]
    # The whole vector, and its two components on the coupler; on the crank it has only one.
    assert len(here) == 4
    assert sum(here) == pytest.approx(3 * here[0], abs=0.35 * np.abs(here[0]).max())


def test_both_modes_inches_copies_and_limits_of_work():
    both = four_bar(effective_components=True, both_modes=True)
    assert "other_rocker_pin_velocity_along_coupler" in both.table.ids
    copies = four_bar(effective_components=True, copies=[{"phase_deg": 180}])
    assert copies.scene and copies.parts
    sliding = gk.load({
        "kind": "slider-crank", "linkage": {"crank": 30, "coupler": 90, "driver": "slider"},
        "stroke": {"start": 70, "end": 110, "step": 5, "speed": 10}, "effective_components": True,
    })  # fmt: skip
    assert np.isfinite(sliding.table["crank_pin_velocity_across_crank"]).all()


def test_polygons_list_the_components_that_are_equal_across_the_slot():
    recipe = gk.load("recipes/polygons.toml")
    table = recipe.table
    chosen = (table["kind"] == "across") & (table["polygon"] == "velocity") & (table["body"] == "slot")
    assert len(set(table["to"][chosen])) == 2 and np.ptp(table["size"][chosen]) < 1e-9 * table["size"].max()
