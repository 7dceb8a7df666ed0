"""Plots as SVG files, read back: curves lie where the ticks of the axes place the numbers of the table."""

import re
from dataclasses import replace
from pathlib import Path
from urllib.parse import unquote_to_bytes
from xml.etree import ElementTree

import numpy as np
import pytest

import geomkin as gk
from geomkin.export.tables import hodograph_file, plot_file
from geomkin.model.scene import Limit, Plot
from geomkin.recipe.shown import ShownRecipe

RECIPES = Path(__file__).parent.parent.parent / "recipes"
SVG = "{http://www.w3.org/2000/svg}"


class Reading:
    """A plot as a reader takes numbers from it: with two ticks of each axis as the scale."""

    def __init__(self, content):
        self.root = ElementTree.fromstring(content)
        self.texts = [(t.text, t.attrib) for t in self.root.iter(f"{SVG}text")]
        self.x = self._scale("x", lambda t: t.get("text-anchor") == "middle" and "transform" not in t)
        self.y = self._scale("y", lambda t: t.get("text-anchor") == "end" and "fill" not in t)
        paths = [p for p in self.root.iter(f"{SVG}path") if p.get("stroke-width") == "1.75"]
        self.curves = [self._runs(p.get("d")) for p in paths if p.get("stroke-linejoin")]

    def _scale(self, axis, is_tick):
        ticks = []
        for words, attributes in self.texts:
            number = (words or "").replace("\N{MINUS SIGN}", "-").replace(",", "")
            if is_tick(attributes) and re.fullmatch(r"-?[\d.]+(e-?\d+)?", number):
                ticks.append((float(number), float(attributes[axis]) - (4 if axis == "y" else 0)))
        assert 2 < len(ticks) < 12
        (low, start), *_, (high, end) = ticks
        return lambda place: low + (place - start) / (end - start) * (high - low)

    def _runs(self, path):
        runs = [np.array(re.findall(r"[-\d.]+", run), dtype=float).reshape(-1, 2) for run in path.split("M")[1:]]
        # A single value is a dot: a line to itself.
        runs = [run[:1] if len(run) == 2 and (run[0] == run[1]).all() else run for run in runs]
        return [np.column_stack([self.x(run[:, 0]), self.y(run[:, 1])]) for run in runs]


@pytest.mark.parametrize("name", ["crank-rocker", "roller-cam", "gear-pair"])
def test_curves_are_those_of_the_table(name):
    scene = gk.load(RECIPES / f"{name}.toml").scene
    for plot in scene.plots[:3]:
        reading = Reading(plot_file(scene.table, plot))
        drive = scene.table.columns[0].values
        assert len(reading.curves) == len(plot.columns)
        for id, runs in zip(plot.columns, reading.curves):
            values, points = scene.table[id], np.concatenate(runs)
            known = np.isfinite(values)
            assert points[:, 0] == pytest.approx(drive[known], abs=1e-4 * np.ptp(drive))
            assert points[:, 1] == pytest.approx(
                values[known], abs=1e-3 * (np.ptp(values[known]) or abs(values[0]) or 1)
            )


def test_a_missing_value_is_a_gap_and_a_limit_is_a_line_with_its_label():
    scene = gk.load(RECIPES / "crank-rocker.toml").scene
    first, *others = scene.table.columns
    (column,) = [c for c in others if c.id == scene.plots[2].columns[0]]
    values = np.where((first.values > 100) & (first.values < 140), np.nan, column.values)
    table = gk.Table((first, replace(column, values=values)))
    plot = Plot("a <b> & c", (column.id,), (Limit(column.id, 40.0, "at least 40 deg <i>"),))
    content = plot_file(table, plot)
    reading = Reading(content)
    (runs,) = reading.curves
    assert [run[[0, -1], 0].round().tolist() for run in runs] == [[0, 100], [140, 360]]
    (line,) = [p for p in reading.root.iter(f"{SVG}path") if p.get("stroke-dasharray") == "8 4"]
    assert reading.y(float(line.get("d").split()[1].partition("H")[0])) == pytest.approx(40, abs=0.05)
    words = [words for words, _ in reading.texts]
    assert "a <b> & c" in words and "at least 40° <i>" in words
    assert any("crank angle, °" in (w or "") for w in words)


def test_a_recipe_that_names_it_gets_a_file_for_each_plot(tmp_path):
    text = (RECIPES / "wiper.toml").read_text() + '\n[files]\nwrite = ["plots"]\n'
    recipe = gk.load(text).with_name("wiper")
    made = gk.make(recipe, tmp_path)
    plots = [path for path in made.files if path.name.endswith("-plot.svg")]
    assert len(plots) == len(recipe.scene.plots) + len(recipe.scene.choice.plots)
    for path in plots:
        assert Reading(path.read_bytes()).curves


@pytest.mark.parametrize("name", ["loaded-pump", "shaking-force"])
def test_polar_diagrams_have_the_tips_of_the_vectors_at_one_scale_about_the_origin(name):
    scene = gk.load(RECIPES / f"{name}.toml").scene
    assert scene.hodographs
    for hodograph in scene.hodographs:
        reading = Reading(hodograph_file(scene.table, hodograph))
        assert len(reading.curves) == len(hodograph.columns)
        sizes = [np.nanmax(scene.table[id]) for id in hodograph.columns]
        for id, runs in zip(hodograph.columns, reading.curves):
            tips = np.column_stack([scene.table[f"{id}_{axis}"] for axis in "xy"])
            assert np.concatenate(runs) == pytest.approx(tips[np.isfinite(tips[:, 0])], abs=1e-4 * max(sizes))
        (dot,) = reading.root.iter(f"{SVG}circle")
        origin = reading.x(float(dot.get("cx"))), reading.y(float(dot.get("cy")))
        assert origin == pytest.approx((0, 0), abs=1e-4 * max(sizes))
        assert reading.x(1.0) - reading.x(0.0) == pytest.approx(reading.y(0.0) - reading.y(1.0), rel=1e-3)


def test_a_page_shows_the_shaking_force_as_a_picture_of_its_own_file(tmp_path):
    recipe = gk.load((RECIPES / "loaded-pump.toml").read_text() + '\n[files]\nwrite = ["page", "plots"]\n')
    files = {path.name: path for path in gk.make(recipe, tmp_path).files}
    shown = re.search(r"<img src='data:image/svg\+xml,([^']*)'", files["slider-crank.html"].read_text())
    written = files["slider-crank-polar-diagram-of-the-shaking-force-plot.svg"].read_bytes()
    assert unquote_to_bytes(shown[1]) == written


def test_a_mechanical_advantage_is_drawn_up_to_ten_times_its_median_in_inches_too():
    text = 'kind = "slider-crank"\nlinkage = { crank = 30, coupler = 100 }\ndrive = { start_deg = 1, end_deg = 359, step_deg = 2 }'
    for units in ("mm", "in"):
        scene = ShownRecipe(gk.load(f'units = "{units}"\n{text}')).scene
        (plot,) = [plot for plot in scene.plots if plot.title.startswith("mechanical advantage")]
        values = scene.table[plot.columns[0]]
        ends = sorted(limit.value for limit in plot.limits)
        typical = 10 * np.median(np.abs(values[np.isfinite(values)]))
        assert len(ends) == 2 and ends[1] == -ends[0] == pytest.approx(typical, rel=0.5)
        assert np.nanmax(np.abs(values)) > ends[1]
        drawn = np.concatenate(
            [points[:, 1] for runs in Reading(plot_file(scene.table, plot)).curves for points in runs]
        )
        assert np.abs(drawn).max() <= ends[1] * 1.001 and len(drawn) == (np.abs(values) <= ends[1]).sum()
    assert plot.most == pytest.approx(ends[1])
