"""Recipes of coupler curves: every column and mark of an atlas and of cognates, beside linkages that are moved."""

import numpy as np
import pytest

import geomkin as gk

ATLAS = {
    "kind": "four-bar-atlas",
    "linkage": {"ground": 100, "crank": 30, "coupler": 90, "rocker": 70, "origin": [7, -4], "ground_angle_deg": 15},
    "branch": -1,
    "grid": {"length": 60, "height": 40, "rows": 2, "columns": 3, "centre": [45, -10], "chosen": [[2, 3], [1, 1]]},
    "drive": {"step_deg": 2},
}
SLIDER = {
    "kind": "slider-crank-atlas",
    "linkage": {"crank": 30, "coupler": 90, "offset": 8},
    "grid": {"length": 50, "height": 30, "rows": 3, "columns": 2, "dash_deg": 12, "chosen": [[3, 1]]},
}


@pytest.mark.parametrize("reported", [ATLAS, SLIDER], ids=lambda reported: reported["kind"])
def test_the_table_of_an_atlas_has_every_point_and_the_rates_of_those_that_are_chosen(reported):
    recipe = gk.load(reported)
    grid, values = reported["grid"], {c.header: np.asarray(c.values, dtype=float) for c in recipe.table.columns}
    drive = np.radians(values.pop("crank_angle_deg"))
    time = drive / recipe.drive.speed
    motion = gk.move(recipe.linkage, drive, recipe.branch, recipe.drive.speed)
    assert motion.assembled.all()
    x = np.linspace(-0.5, 0.5, grid["columns"]) * grid["length"]
    y = np.linspace(-0.5, 0.5, grid["rows"]) * grid["height"]
    rows, seen = (
        gk.linkage.coupler_grid(grid["length"], grid["height"], grid["rows"], grid["columns"], recipe.grid.centre),
        0,
    )
    assert np.sort_complex(rows.ravel()) == pytest.approx(
        np.sort_complex((x + 1j * y[:, None] + recipe.grid.centre).ravel())
    )
    for i in range(grid["rows"]):
        for j in range(grid["columns"]):
            name = f"r{i + 1}c{j + 1}"
            track = motion.bodies["coupler"].point(rows[i, j])
            place = values.pop(f"{name}_x_mm") + 1j * values.pop(f"{name}_y_mm")
            assert place == pytest.approx(track.position, abs=1e-9)
            if [i + 1, j + 1] in grid["chosen"]:
                seen += 1
                rate = values.pop(f"{name}_velocity_x_mm_per_s") + 1j * values.pop(f"{name}_velocity_y_mm_per_s")
                more = values.pop(f"{name}_acceleration_x_mm_per_s2") + 1j * values.pop(
                    f"{name}_acceleration_y_mm_per_s2"
                )
                # By differences of the places and of the rates.
                for reported_rate, of in ((rate, place), (more, rate)):
                    steps = (of[2:] - of[:-2]) / (time[2:] - time[:-2])
                    assert np.abs(steps - reported_rate[1:-1]).max() < 0.02 * np.abs(reported_rate).max()
    assert not values and seen == len(grid["chosen"])


@pytest.mark.parametrize("reported", [ATLAS, SLIDER], ids=lambda reported: reported["kind"])
def test_an_atlas_is_drawn_in_dashes_with_its_points_on_the_linkage(reported):
    recipe = gk.load(reported)
    (part,) = recipe.parts
    drive = np.radians(np.linspace(0, 360, 20_001))
    motion = gk.move(recipe.linkage, drive, recipe.branch)
    curves = [motion.bodies["coupler"].point(z).position for z in recipe.grid.points.ravel()]
    small = recipe.stock.pin_diameter / 8
    dots = [
        mark.centre for mark in part.marks if isinstance(mark, gk.plane.Circle) and mark.radius == pytest.approx(small)
    ]
    assert np.array(dots) == pytest.approx(np.array([curve[0] for curve in curves]))
    # What is no dot and no part of the linkage lies on a curve.
    ends = [mark.point(mark.breaks[[0, -1]]) for mark in part.marks if not isinstance(mark, gk.plane.Circle)]
    every = np.concatenate(curves)
    on = [np.abs(end[:, None] - every).min(axis=1).max() < 0.05 for end in ends]
    assert sum(on) >= len(curves) * 180 // reported["grid"].get("dash_deg", 5) - len(curves)
    assert len(on) - sum(on) < 20
    # The scene has a trail for each of them.
    trails = {mark.label: mark.place for mark in recipe.scene.marks if mark.trail}
    assert len(trails) >= len(curves) and {"r1c1", "r2c2"} <= set(trails)


def test_the_tables_of_cognates_are_those_of_three_linkages_that_run_beside_each_other():
    recipe = gk.load({
        "kind": "cognates", "branch": -1, "drive": {"step_deg": 30},
        "linkage": {"ground": 100, "crank": 30, "coupler": 90, "rocker": 70, "coupler_point": [50, 45], "origin": [5, 2]},
    })  # fmt: skip
    values = {c.header: np.asarray(c.values, dtype=float) for c in recipe.table.columns}
    drive = np.radians(values["drive_angle_deg"])
    tracks = []
    for name, one in zip(("given", "left", "right"), gk.linkage.cognates(recipe.linkage)):
        motion = gk.move(one.linkage, drive + one.drive_offset, -one.branch)
        for body in ("crank", "coupler", "rocker"):
            angle = np.radians(values[f"{name}_{body}_angle_deg"])
            assert np.exp(1j * angle) == pytest.approx(motion.bodies[body].direction, abs=1e-9)
            assert np.abs(np.diff(angle)).max() < np.pi
        tracks.append(values[f"{name}_coupler_point_x_mm"] + 1j * values[f"{name}_coupler_point_y_mm"])
        assert tracks[-1] == pytest.approx(motion.point("coupler_point").position, abs=1e-9)
    assert np.ptp(tracks, axis=0) == pytest.approx(np.zeros(len(drive)), abs=1e-9)
    assert max(check.value for check in recipe.design_checks[1:3]) < 1e-6
