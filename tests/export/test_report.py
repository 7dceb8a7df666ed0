"""The report: its formulas evaluated from their written numbers, against the table of the motion; its files."""

import json
import re
from math import acos, asin, atan2, cos, degrees, pi, radians, sin, sqrt
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import geomkin as gk
from geomkin.cam.program.laws import LAWS
from geomkin.export import report
from geomkin.export.formats import WRITERS
from tests.campaign import by_default

RECIPES = Path(__file__).parent.parent.parent / "recipes"
FOUR_BAR = {"kind": "four-bar", "linkage": {"ground": 100, "crank": 30, "coupler": 90, "rocker": 70}}


def calculated(text, known=None):
    """The value of a text with numbers and known symbols, with angles in deg."""
    text = re.sub(r"((?:\(-)?[\w.]+(?:e-\d+)?\)?) deg", r"radians(\1)", text).replace("^", "**")
    names = {
        "radians": radians, "sqrt": sqrt, "sin": sin, "cos": cos, "abs": abs, "pi": pi,
        "arcsin": lambda value: degrees(asin(value)), "arccos": lambda value: degrees(acos(value)),
        "atan2": lambda y, x: degrees(atan2(y, x)),
    }  # fmt: skip
    return eval(text, {"__builtins__": {}}, names | (known or {}))


def by_hand(formula):
    """The value of a formula from the numbers in its text; that of a given number is given."""
    return calculated(formula.substituted) if formula.expression else formula.value


REPORTED = ["crank-rocker", "slider-crank", "roller-cam", "gear-pair", "geneva", "belt-drive"]


@pytest.mark.parametrize("name", by_default(REPORTED, ["crank-rocker", "gear-pair"]))
def test_each_line_of_a_report_follows_from_the_lines_above_it(name, tmp_path):
    """Only the text of the report is read, as a person with a calculator does."""
    recipe = gk.load(RECIPES / f"{name}.toml")
    gk.write(recipe, tmp_path / "a-report.md")
    text = (tmp_path / "a-report.md").read_text().split("## Formulas")[1].split("\n## ")[0]
    rows = re.findall(r"^\| (\w+) \| [^|]+ \| ([-\d.e]+) \|", text, re.MULTILINE)
    known = {symbol: float(value) for symbol, value in rows}
    lines = re.findall(r"```\n(\w+) = (.+)\n  = (.+)\n  = ([-\d.e+]+).*\n```", text)
    assert len(lines) == sum(bool(formula.expression) for formula in recipe.formulas) > 5
    for symbol, expression, substituted, value in lines:
        printed = float(value)
        for found in (calculated(substituted), calculated(expression, known)):
            assert found == pytest.approx(printed, rel=2e-5, abs=2e-5), symbol
        known[symbol] = printed


FORMS = {
    "plain": {},
    "other branch": {"branch": -1},
    "inches, turned": {"units": "in", "linkage": {"ground_angle_deg": 25}},
    "accelerated": {"drive": {"speed_rpm": 30, "acceleration_rad_per_s2": 3}},
}


@pytest.mark.parametrize("form", FORMS)
def test_numbers_of_a_four_bar_by_hand_are_those_of_its_table(form):
    further = dict(FORMS[form])
    linkage = {**FOUR_BAR["linkage"], "coupler_point": [40, 25], **further.pop("linkage", {})}
    recipe = gk.load({**FOUR_BAR, "linkage": linkage, **further})
    formulas = {formula.symbol: formula for formula in recipe.formulas}
    for formula in formulas.values():
        assert by_hand(formula) == pytest.approx(formula.value, rel=1e-5, abs=1e-4)
    row, scale = len(recipe.table.columns[0].values) // 6, 25.4 if recipe.units == "in" else 1.0
    turn = linkage.get("ground_angle_deg", 0)
    expected = {"mu": "transmission_angle", "omega_c": "rocker_omega", "omega_b": "coupler_omega"}
    expected |= {"alpha_c": "rocker_alpha", "alpha_b": "coupler_alpha"}
    for symbol, column in expected.items():
        value = recipe.table[column][row]
        assert formulas[symbol].value == pytest.approx(
            min(value, 180 - value) if symbol == "mu" and value > 90 else value
        )
    for symbol, column in {"phi": "rocker_angle", "beta": "coupler_angle"}.items():
        assert (formulas[symbol].value + turn - recipe.table[column][row]) % 360 == pytest.approx(0, abs=1e-9) or (
            360 - (formulas[symbol].value + turn - recipe.table[column][row]) % 360
        ) == pytest.approx(0, abs=1e-9)
    place = complex(formulas["x"].value, formulas["y"].value) * scale * np.exp(1j * np.radians(turn))
    assert place == pytest.approx(complex(recipe.table["coupler_point_x"][row], recipe.table["coupler_point_y"][row]))
    velocity = complex(formulas["v_x"].value, formulas["v_y"].value) * scale * np.exp(1j * np.radians(turn))
    assert velocity == pytest.approx(
        complex(*(recipe.table[f"coupler_point_velocity_{axis}"][row] for axis in "xy")), rel=1e-9
    )
    # The least transmission angle of the whole turn is one of both with the crank along the ground.
    (check,) = (check for check in recipe.checks if check.id == "transmission_angle")
    assert min(formulas[symbol].value for symbol in ("mu_1", "mu_2")) == pytest.approx(check.value)


def worked(recipe):
    """The formulas by symbol, each of which has the value of its own text."""
    for formula in recipe.formulas:
        assert by_hand(formula) == pytest.approx(formula.value, rel=1e-5, abs=1e-4)
    return {formula.symbol: formula.value for formula in recipe.formulas}


@pytest.mark.parametrize("form", FORMS)
def test_numbers_of_a_slider_crank_by_hand_are_those_of_its_table(form):
    further = dict(FORMS[form])
    linkage = {"crank": 30, "coupler": 90, "offset": 12, **further.pop("linkage", {})}
    recipe = gk.load({"kind": "slider-crank", "linkage": linkage, **further})
    found, row = worked(recipe), len(recipe.table.columns[0].values) // 6
    unit = 25.4 if recipe.units == "in" else 1.0
    columns = {"x": "slide_displacement", "v": "slide_velocity", "A": "slide_acceleration"}
    for symbol, column in columns.items():
        assert found[symbol] * unit == pytest.approx(recipe.table[column][row], abs=1e-6), symbol
    for symbol, column in {"omega_b": "coupler_omega", "alpha_b": "coupler_alpha"}.items():
        assert found[symbol] == pytest.approx(recipe.table[column][row])
    angle = recipe.table["transmission_angle"][row]
    assert found["mu"] == pytest.approx(min(angle, 180 - angle))
    # The farthest positions, by brute force over a turn.
    table = gk.move(recipe.linkage, np.linspace(0, 2 * np.pi, 20001), recipe.branch)
    assert found["S"] * unit == pytest.approx(np.ptp(table.slide("slide").displacement), abs=1e-4)


FOLLOWERS = [
    {"kind": "translating-roller", "roller_radius": 8, "offset": 6},
    {"kind": "oscillating-roller", "roller_radius": 8, "pivot_distance": 95, "arm_length": 75, "side": "below"},
    {"kind": "translating-flat"},
]


def cam(law, follower, **further):
    angle = "_deg" if "oscillating" in follower["kind"] else ""
    program = [
        {"kind": "dwell", "end_deg": 50},
        {"kind": "rise", "law": law, f"rise{angle}": 9, "end_deg": 150},
        {"kind": "return", "law": "4-5-6-7", "end_deg": 360},
    ]
    table = {"base_radius": 45, "direction": "clockwise", "follower": follower, "program": program}
    return gk.load({"kind": "disk-cam", "cam": table, **further})


@pytest.mark.parametrize(
    ("law", "follower"), [*((law, FOLLOWERS[0]) for law in LAWS), *(("3-4-5", one) for one in FOLLOWERS[1:])]
)
def test_numbers_of_a_cam_by_hand_are_those_of_its_table(law, follower):
    recipe = cam(law, follower, drive={"speed_rpm": 90, "acceleration_rad_per_s2": 5})
    found, table = worked(recipe), recipe.table
    row = int(np.argmin(np.abs(table["cam_angle"] - (50 + 100 * found["x"]))))
    size = np.degrees(1) if "oscillating" in follower["kind"] else 1.0
    assert found["s"] * size == pytest.approx(table["lift"][row])
    assert found["v"] == pytest.approx(table["velocity"][row])
    assert found["a"] == pytest.approx(table["acceleration"][row])
    if "mu" in found:
        assert found["mu"] == pytest.approx(table["pressure_angle"][row])
    else:
        assert 1 / found["rho"] == pytest.approx(table["profile_curvature"][row])


@pytest.mark.campaign
def test_a_cam_by_a_table_has_no_formulas():
    assert gk.load(RECIPES / "table-cam.toml").formulas == ()


@pytest.mark.parametrize("internal", [False, True])
def test_numbers_of_a_geneva_drive_by_hand_are_differences_of_its_rotation(internal):
    drive = {"speed_rpm": 40, "acceleration_rad_per_s2": 3}
    wheel = {"distance": 80, "slots": 6, "pins": 1, "internal": internal}
    recipe = gk.load({"kind": "geneva", "geneva": wheel, "drive": drive})
    found, wheel, step = worked(recipe), recipe.geneva, 1e-4
    turn = np.pi - wheel.half_motion / 2 + step * np.array([-1, 0, 1])
    low, middle, high = wheel.rotation(turn)
    speed, first = recipe.drive.speed, (high - low) / (2 * step)
    assert found["omega_w"] == pytest.approx(first * speed, rel=1e-6)
    second = (high - 2 * middle + low) / step**2
    assert found["alpha_w"] == pytest.approx(second * speed**2 + first * 3, rel=1e-5)
    assert found["r"] == pytest.approx(wheel.crank_radius) and found["d"] == pytest.approx(wheel.dwell)


@pytest.mark.parametrize("name", ["belt-drive", "chain-drive"])
def test_strands_and_arcs_of_a_loop_are_its_length(name):
    found = worked(gk.load(RECIPES / f"{name}.toml"))
    assert found["L"] == pytest.approx(found["L_N"], rel=1e-7)


@pytest.mark.parametrize("units", ["mm", "in"])
def test_numbers_of_gears_by_hand_are_those_of_the_pair(units):
    data = {
        "kind": "gear-pair",
        "units": units,
        "first": {"teeth": 18, "module": 3},
        "second": {"teeth": 24, "module": 3},
    }
    recipe = gk.load(data)
    formulas = {formula.symbol: formula for formula in recipe.formulas}
    for formula in formulas.values():
        assert by_hand(formula) == pytest.approx(formula.value, rel=1e-5, abs=1e-4)
    assert formulas["epsilon"].value == pytest.approx(recipe.design.contact_ratio)
    assert formulas["d_2"].value == pytest.approx(72)


def test_markdown_has_each_check_and_each_formula_and_its_pictures(tmp_path):
    recipe = gk.load(RECIPES / "crank-rocker.toml")
    files = gk.write(recipe, tmp_path / "a-report.md")
    text = (tmp_path / "a-report.md").read_text()
    for formula in recipe.formulas:
        assert formula.substituted in text
    assert all(check.name[1:].replace("_", " ") in text for check in recipe.checks)
    assert gk.load(text.split("```")[1].strip()) == recipe
    named = set(re.findall(r"\]\((.+\.svg)\)", text))
    assert named == {path.name for path in files} - {"a-report.md"} and len(named) > 4


def test_without_the_package_a_pdf_is_refused_by_name(tmp_path, monkeypatch):
    monkeypatch.setattr(report, "TYPST", "typst_that_is_missing")
    recipe = gk.load(RECIPES / "spur-gear.toml")
    for name in ("report", "sheet-pdf"):
        tail = WRITERS[name].tail
        with pytest.raises(gk.DesignError) as refused:
            gk.write(recipe, tmp_path / f"a{tail}")
        assert refused.value.field == "write" and "pip install" in str(refused.value)
    assert not list(tmp_path.iterdir())


def test_steps_are_items_of_a_list_in_markdown_and_pdf(monkeypatch, tmp_path):
    sources = []
    compiler = SimpleNamespace(compile=lambda files, **_: sources.append(files["main"].decode()) or b"%PDF")
    monkeypatch.setattr(report, "_typst", lambda: compiler)
    recipe = gk.load(FOUR_BAR)
    gk.write(recipe, tmp_path / "a-report.pdf")
    steps = [line for line in (tmp_path / "a-report.md").read_text().splitlines() if line.startswith("- ")]
    (listed,) = re.findall(r"^#list\((.*)\)$", sources[0], re.MULTILINE)
    assert len(steps) > 2 and len(json.loads(f"[{listed}]")) == len(steps) and '"- ' not in sources[0]


def test_pdf_is_the_same_on_each_run(tmp_path):
    pytest.importorskip("typst")
    recipe = gk.load({**FOUR_BAR, "files": {"title": {"name": 'a "quoted" # name'}}})
    for tail in ("-report.pdf", "-sheet.pdf"):
        contents = []
        for folder in ("1", "2"):
            (tmp_path / folder).mkdir(exist_ok=True)
            gk.write(recipe, tmp_path / folder / f"a{tail}")
            contents.append((tmp_path / folder / f"a{tail}").read_bytes())
        assert contents[0] == contents[1] and contents[0].startswith(b"%PDF")
