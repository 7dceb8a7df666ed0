"""Scenes of linkages that do not close at every frame, and how large polygons are drawn."""

import numpy as np
import pytest

import geomkin as gk
from tests.gallery import named

LIMITED = 'kind = "four-bar"\nlinkage = {ground = 100, crank = 80, coupler = 60, rocker = 50}\ndrive = {step_deg = 5}\n'


def test_copies_stand_open_where_any_of_them_does_and_each_is_where_its_own_crank_is():
    text = LIMITED + "copies = [{phase_deg = 40}, {phase_deg = 100, mirrored = true}]\n"
    own, alone = gk.load(text), gk.load(LIMITED)
    scene = own.scene
    there = np.array([np.isfinite(body.direction) for body in scene.bodies]).all(axis=0)
    assert np.array_equal(scene.assembled, there) and 0 < scene.assembled.sum() < alone.scene.assembled.sum()
    crank = named(scene, "crank, copy 2").direction
    ahead = np.exp(1j * np.radians(np.asarray(scene.drive.values) + 40))
    assert np.abs(crank - ahead)[np.isfinite(crank)].max() < 1e-9
    high = max(body.layer for body in alone.scene.bodies) + 1
    layers = {body.name: body.layer for body in scene.bodies}
    for body in alone.scene.bodies:
        assert layers[f"{body.name}, copy 2"] == high + body.layer
        # Turned over, the lowest is the highest.
        assert layers[f"{body.name}, copy 3"] == 3 * high - 1 - body.layer
    assert [body.name for body in scene.bodies if body.named] == [body.name for body in alone.scene.bodies]


def test_only_columns_with_a_known_value_are_plotted():
    scene = gk.load(LIMITED).scene
    assert not scene.assembled.all()
    plotted = {column for plot in scene.plots for column in plot.columns}
    known = {column.id for column in scene.table.columns if np.isfinite(column.values).any()}
    assert plotted <= known
    assert {"coupler_angle", "rocker_angle", "transmission_angle", "coupler_omega"} <= plotted
    never = gk.move(gk.FourBar(100, 80, 60, 50), np.linspace(3, 3.2, 7))
    assert not never.assembled.any()
    reported = {
        header
        for plot in gk.linkage.linkage_scene(never, gk.linkage.motion_table(never)).plots
        for header in plot.columns
    }
    assert not reported & plotted


@pytest.mark.parametrize(
    ("kind", "sizes", "point", "first"),
    [
        ("slider-crank", "crank = 30, coupler = 100", [0, 0], ["slide_displacement", "slide_velocity"]),
        ("slider-crank", "crank = 30, coupler = 100", [50, 20], ["coupler_point_x", "slide_displacement"]),
        (
            "four-bar",
            "ground = 100, crank = 30, coupler = 90, rocker = 70",
            [0, 0],
            ["coupler_angle", "transmission_angle"],
        ),
    ],
)
def test_outputs_are_plotted_first_and_the_path_of_a_point_on_a_pin_never(kind, sizes, point, first):
    scene = gk.load(
        f'kind = "{kind}"\nlinkage = {{ {sizes}, coupler_point = {point} }}\ndrive = {{step_deg = 10}}'
    ).scene
    assert [plot.columns[0] for plot in scene.plots[:2]] == first
    plotted = {column for plot in scene.plots for column in plot.columns}
    assert ("coupler_point_x" in plotted) == (point != [0, 0])
    if kind == "four-bar":
        assert "rocker_angle" in scene.plots[0].columns
