"""The counterbalance that is judged where nothing, or next to nothing, is left to balance."""

import pytest

import geomkin as gk

CHECK = "largest force, given to best counterbalance"


@pytest.fixture
def judged(tmp_path):
    """The check of a slider-crank of 30 and 90 mm with masses and a counterbalance."""

    def make(masses, given, speed=60):
        (tmp_path / "r.toml").write_text(
            f'kind = "shaking-force"\ncounterbalance = {given}\nlinkage = {{crank = 30, coupler = 90}}\n'
            f'masses = {{{masses}}}\ndrive = {{step_deg = 30, speed_rpm = {speed}}}\nfiles = {{write = ["csv"]}}\n'
        )
        made = gk.make(tmp_path / "r.toml", tmp_path / "out")
        return next(check for check in made.checks if check.name == CHECK)

    return make


def test_what_has_no_mass_shakes_with_no_force_and_passes(judged):
    assert judged("", 0).value == 1 and judged("", 0).passed
    assert not judged("", 5).passed


@pytest.mark.parametrize("speed", [0.01, 60, 1e5])
def test_a_crank_alone_is_balanced_wholly_by_its_own_product(judged, speed):
    crank = "crank = 0.5, crank_centre = [10, 0]"
    assert judged(crank, 5, speed).passed
    for given in (4.9999, 5.0001, 0, 10, -5):
        check = judged(crank, given, speed)
        assert not check.passed and check.advice == "give counterbalance = 5"


def test_the_quotient_is_that_of_the_largest_forces(judged):
    """Of a slider alone, by its acceleration at the dead centres: r w^2 (1 + r / l) there, r w^2 (1 - r / l) here."""
    check = judged("slider = 2", 0)
    # The best product takes the outer peak, 2 r (1 + 1/3), down until it meets a peak elsewhere.
    best = gk.linkage.best_counterbalance(gk.SliderCrank(30, 90), gk.linkage.SliderCrankMasses(slider=2)).largest
    assert check.value == pytest.approx(2 * 30 * (1 + 1 / 3) * 1e-3 / best, rel=1e-9)
