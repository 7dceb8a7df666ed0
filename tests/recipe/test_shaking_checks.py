"""The counterbalance that is judged where nothing, or next to nothing, is left to balance."""

import numpy as np
import pytest

import geomkin as gk

CHECK = "largest force, given to best counterbalance"


@pytest.fixture
def design_checks(tmp_path):
    """The check of a slider-crank of 30 and 90 mm with masses and a counterbalance."""

    def make(masses, given, speed=60):
        (tmp_path / "r.toml").write_text(
            f'kind = "shaking-force"\ncounterbalance = {given}\nlinkage = {{crank = 30, coupler = 90}}\n'
            f'masses = {{{masses}}}\ndrive = {{step_deg = 30, speed_rpm = {speed}}}\nfiles = {{write = ["csv"]}}\n'
        )
        made = gk.make(tmp_path / "r.toml", tmp_path / "out")
        return next(check for check in made.checks if check.name == CHECK)

    return make


def test_the_quotient_is_that_of_the_largest_forces(design_checks):
    """Of a slider alone, by its acceleration at the dead centres: r w^2 (1 + r / l) there, r w^2 (1 - r / l) here."""
    check = design_checks("slider = 2", 0)
    # The best product takes the outer peak, 2 r (1 + 1/3), down until it meets a peak elsewhere.
    best = gk.linkage.best_counterbalance(gk.SliderCrank(30, 90), gk.linkage.SliderCrankMasses(slider=2)).largest
    assert check.value == pytest.approx(2 * 30 * (1 + 1 / 3) * 1e-3 / best, rel=1e-9)


def test_table_may_start_at_any_angle():
    def table(start, end):
        masses = {"slider": 2, "crank": 0.5, "crank_centre": [10, 3]}
        drive = {"start_deg": start, "end_deg": end, "step_deg": 30, "speed_rpm": 120}
        linkage = {"crank": 30, "coupler": 90, "offset": 8}
        recipe = {"kind": "shaking-force", "linkage": linkage, "masses": masses, "counterbalance": 7, "drive": drive}
        return gk.load(recipe).table

    whole, later = table(0, 360), table(90, 450)
    assert later["time"] == pytest.approx(np.linspace(0, 0.5, 13)) == whole["time"]
    for name in ("none", "given", "best"):
        sizes = [table[f"force_{name}"] for table in (whole, later)]
        assert np.roll(sizes[0][:-1], -3) == pytest.approx(sizes[1][:-1])
        x, y = later[f"force_{name}_x"], later[f"force_{name}_y"]
        assert np.hypot(x, y) == pytest.approx(sizes[1])
    # The best leaves the least at its worst, and what is given is a product of 7 kg mm at 4 pi rad/s off none.
    worst = {name: whole[f"force_{name}"].max() for name in ("none", "given", "best")}
    assert worst["best"] < worst["given"] < worst["none"]
    along = whole["force_none_x"] - whole["force_given_x"] + 1j * (whole["force_none_y"] - whole["force_given_y"])
    assert along == pytest.approx(7e-3 * (4 * np.pi) ** 2 * np.exp(1j * np.radians(whole["crank_angle"])), abs=1e-9)
