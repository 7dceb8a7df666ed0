"""Optimisation finds known optima, gives the same result again, and names the constraint that nothing meets."""

import signal
from concurrent.futures import Executor, ThreadPoolExecutor

import numpy as np
import pytest
from click.testing import CliRunner

import geomkin as gk
from geomkin.cli import cli
from geomkin.optimisation.designs import Trials
from tests.campaign import by_default
from tests.sweeps.test_sweep import Backwards, spawned

FOUR_BAR = {"kind": "four-bar", "linkage": {"ground": 100, "crank": 30, "coupler": 90, "rocker": 70}}
GEAR = {"kind": "spur-gear", "gear": {"teeth": 24, "module": 2, "profile_shift": 0.0}}
SIDES = {"linkage.coupler": (60.0, 120.0), "linkage.rocker": (60.0, 120.0)}
TRANSMISSION = "-min(transmission_angle)"


def transmission_angle(ground, crank, coupler, rocker):
    """Least acute angle between coupler and rocker of a crank-rocker, deg, by the cosine rule at the two extremes."""
    diagonals = ground - crank, ground + crank
    cosines = [(coupler**2 + rocker**2 - d**2) / (2 * coupler * rocker) for d in diagonals]
    return 90 - np.degrees(np.arcsin(np.max(np.abs(cosines), axis=0)))


def test_best_transmission_angle_of_a_crank_rocker():
    """With 2 b^2 = a^2 + d^2 the diagonals deviate equally from a right angle, so sin of the deviation is 2 a d / (a^2 + d^2)."""
    best = gk.optimise(FOUR_BAR, SIDES, TRANSMISSION, starts=2)
    side = np.sqrt((30**2 + 100**2) / 2)
    assert best.values["linkage.coupler"] == pytest.approx(side, rel=1e-6)
    assert best.values["linkage.rocker"] == pytest.approx(side, rel=1e-6)
    assert -best.objective == pytest.approx(90 - np.degrees(np.arcsin(2 * 30 * 100 / (30**2 + 100**2))), abs=1e-6)
    assert best.recipe.design.coupler == best.values["linkage.coupler"]


def swing(crank, coupler, rocker):
    """Swing of the rocker, deg, from its two positions in line with the crank."""
    angles = [
        np.arccos((100**2 + rocker**2 - (coupler + sign * crank) ** 2) / (2 * 100 * rocker)) for sign in (1.0, -1.0)
    ]
    return np.degrees(angles[0] - angles[1])


def test_constrained_optimum_agrees_with_a_grid():
    """The largest rocker swing with a transmission angle of 40 deg at least."""
    crank, coupler = np.meshgrid(np.linspace(25, 45, 401), np.linspace(60, 110, 501), indexing="ij")
    with np.errstate(invalid="ignore"):
        feasible = (transmission_angle(100, crank, coupler, 70) >= 40) & (crank + 100 <= coupler + 70)
        largest = np.max(swing(crank, coupler, 70), where=feasible, initial=0)
    best = gk.optimise(
        FOUR_BAR,
        {"linkage.crank": (25, 45), "linkage.coupler": (60, 110)},
        "-range(rocker_angle)",
        "min(transmission_angle) >= 40",
        starts=3,
    )
    assert best.constraints[0].passed and best.constraints[0].value == pytest.approx(40, abs=1e-5)
    # The motion is sampled at whole degrees, so that its range is slightly below the swing.
    assert -best.objective == pytest.approx(largest, rel=2e-3)


def test_whole_numbers_are_enumerated():
    """The gear of the thinnest rim whose teeth are wide enough at their tips and not undercut, of all numbers of teeth."""
    sweep = gk.sweep(GEAR, {"gear.teeth": "8:20:1"})
    checks = {row.values["gear.teeth"]: {check.id: check.value for check in row.checks} for row in sweep.rows}
    allowed = [teeth for teeth, found in checks.items() if found["undercut"] <= 0 and found["tip_thickness"] >= 0.47]
    best = gk.optimise(GEAR, {"gear.teeth": (7.5, 20)}, "rim", ["undercut <= 0", "tip_thickness >= 0.47"])
    assert best.values == {"gear.teeth": min(allowed, key=lambda teeth: checks[teeth]["rim"])}
    assert isinstance(best.recipe.gear.teeth, int) and best.evaluations < 30


def test_whole_number_without_a_value_of_its_own_is_enumerated():
    belt = {"kind": "belt-drive", "pulleys": [{"teeth": 20}, {"teeth": 30, "at": [60, 0]}]}
    best = gk.optimise(belt, {"belt.teeth": (80.5, 85.5)}, "-room", starts=1)
    assert best.values == {"belt.teeth": 85} and best.evaluations == 5


def test_a_length_outside_its_range_of_whole_numbers_still_varies_continuously():
    best = gk.optimise(FOUR_BAR, {"linkage.coupler": (70, 80), "linkage.rocker": (60, 80)}, TRANSMISSION, starts=1)
    assert best.values["linkage.coupler"] == pytest.approx(np.sqrt((30**2 + 100**2) / 2), rel=1e-5)


@pytest.mark.campaign
def test_path_passes_through_points_of_a_known_linkage():
    linkage = gk.FourBar(100, 30, 90, 70, coupler_point=40 + 25j)
    points = gk.move(linkage, np.radians([10, 80, 150, 230])).point("coupler_point").position
    recipe = {"kind": "four-bar", "linkage": {**FOUR_BAR["linkage"], "coupler_point": [35, 30]}}
    target = [[float(z.real), float(z.imag)] for z in points]
    vary = {"linkage.coupler_point[0]": (20, 60), "linkage.coupler_point[1]": (0, 50)}
    best = gk.optimise(recipe, vary, f"max(distance(coupler_point, {target}))", starts=1)
    assert list(best.values.values()) == pytest.approx([40, 25], abs=0.05)


def test_same_seed_gives_the_same_result():
    first, second = (gk.optimise(FOUR_BAR, SIDES, "max(rocker_alpha)", starts=2, seed=3) for _ in range(2))
    assert first.values == second.values and first.evaluations == second.evaluations


# At the start the rocker swings too little, so that the constraint has to be met first.
SWINGS = (
    FOUR_BAR | {"drive": {"step_deg": 20}},
    {"linkage.crank": (10, 32), "linkage.rocker": (60, 110)},
    "range(rocker_angle) >= 62",
)
TASKS = {
    "one": (*SWINGS[:2], TRANSMISSION, SWINGS[2]),
    "front": (GEAR, {"gear.teeth": (8, 20)}, ["rim", "-tip_thickness"], "undercut <= 0.999999"),
    "front of a four-bar": (*SWINGS[:2], ["-range(rocker_angle)", "max(rocker_omega)"], SWINGS[2]),
}


@pytest.mark.parametrize("made", by_default([lambda: ThreadPoolExecutor(3), Backwards, spawned], [Backwards]))
@pytest.mark.parametrize("arguments", by_default(TASKS, ["one", "front"]))
def test_any_executor_gives_the_same_files(tmp_path, made, arguments):
    arguments = TASKS[arguments]

    def files(executor, folder):
        best = gk.optimise(*arguments, starts=2, out=tmp_path / folder, executor=executor)
        return best.evaluations, {path.name: path.read_bytes() for path in best.files}

    with made() as executor:
        assert files(executor, "shared") == files(None, "alone")


def test_failure_of_the_executor_is_named(tmp_path):
    class Failing(Executor):
        def submit(self, *_):
            raise RuntimeError("out of light")

    with pytest.raises(gk.DesignError, match="out of light") as refused:
        gk.optimise(FOUR_BAR, SIDES, TRANSMISSION, starts=1, executor=Failing())
    assert refused.value.field == "executor"


def command(folder):
    (folder / "bar.toml").write_text(gk.recipe.to_toml(gk.load(FOUR_BAR)))
    ranges = [argument for key in SIDES for argument in ("--vary", f"{key}=60:120")]
    return [
        "optimise",
        str(folder / "bar.toml"),
        "--minimise",
        TRANSMISSION,
        "--out",
        str(folder),
        "--starts=1",
        *ranges,
    ]


VARY = {"linkage.crank": (20, 40)}


@pytest.mark.parametrize(
    ("vary", "minimise", "subject_to", "field", "named"),
    [
        ({"kind": (1, 2)}, TRANSMISSION, (), "kind", "four-bar"),
        ({"linkage.krank": (1, 2)}, TRANSMISSION, (), "linkage.krank", "crank"),
        ({"linkage.crank[3]": (1, 2)}, TRANSMISSION, (), "linkage.crank[3]", "crank"),
        ({"linkage.crank": (40, 20)}, TRANSMISSION, (), "linkage.crank", "40 to 20"),
        ({"linkage.crank": (-2, -1)}, TRANSMISSION, (), "linkage.crank", "above 0"),
        ({"linkage.crank": (-5, 40)}, TRANSMISSION, (), "linkage.crank", "above 0"),
        ({"linkage.crank": (0, 1e12)}, TRANSMISSION, (), "linkage.crank", "at most"),
        ({"files.labels": (0, 1)}, TRANSMISSION, (), "files.labels", "geomkin sweep --set files.labels="),
        ({"files.curves": (0, 1)}, TRANSMISSION, (), "files.curves", "geomkin sweep --set files.curves="),
        ({"drive": (0, 1)}, TRANSMISSION, (), "drive", "number"),
        ({"": (1, 2)}, TRANSMISSION, (), "", "empty"),
        ({}, TRANSMISSION, (), "vary", "linkage.crank"),
        (VARY, "min(transmission_angel)", (), "minimise", "transmission_angle"),
        (VARY, "transmission_angle", (), "minimise", "max"),
        (VARY, "distance(coupler_point, [1, 2])", (), "minimise", "points"),
        (VARY, "max(rocker_omega + distance(coupler_point, [[1, 2], [3, 4]]))", (), "minimise", "rocker_omega"),
        (VARY, TRANSMISSION, "min(transmission_angle)", "subject_to", ">="),
        (VARY, TRANSMISSION, "40 <= mu", "subject_to", "mu"),
    ],
)
def test_wrong_input_is_refused_by_name(vary, minimise, subject_to, field, named):
    with pytest.raises(gk.DesignError) as refused:
        gk.optimise(FOUR_BAR, vary, minimise, subject_to, starts=1)
    assert refused.value.field == field
    assert named in str(refused.value)


TABLE = {"vary": ["linkage.coupler = 60:120", "linkage.rocker = 60:120"], "minimise": TRANSMISSION}


@pytest.mark.campaign
def test_table_of_the_recipe_gives_the_search(tmp_path):
    """The same optimum as by arguments, by the command without options, and by the recipe that it writes."""
    recipe = {**FOUR_BAR, "optimise": {**TABLE, "subject_to": ["max(rocker_angle) <= 150"]}}
    best = gk.optimise(FOUR_BAR, SIDES, TRANSMISSION, "max(rocker_angle) <= 150", starts=1)
    assert gk.optimise(recipe, starts=1).values == best.values
    assert gk.optimise(recipe, subject_to=(), starts=1).objective < best.objective - 1
    (tmp_path / "bar.toml").write_text(gk.recipe.to_toml(gk.load(recipe)))
    result = CliRunner().invoke(cli, ["optimise", str(tmp_path / "bar.toml"), "--out", str(tmp_path), "--starts=1"])
    assert result.exit_code == 0 and "max(rocker_angle) <= 150" in result.output, result.output
    written = gk.load(tmp_path / "bar" / "bar.optimum.toml")
    assert written.optimise == gk.load(recipe).optimise
    assert written.design.coupler == pytest.approx(best.values["linkage.coupler"], rel=1e-12)


@pytest.mark.parametrize(
    ("changes", "field", "named"),
    [
        ({"vary": ["linkage.coupler = 60"]}, "optimise.vary", "LOW:HIGH"),
        ({"vary": ["linkage.coupler = nan:60"]}, "optimise.vary", "LOW:HIGH"),
        ({"vary": ["linkage.coupler = 60:inf"]}, "optimise.vary", "LOW:HIGH"),
        ({"vary": ["linkage.coupler = 60:120", "linkage.coupler = 60:90"]}, "optimise.vary", "twice"),
        ({"vary": []}, "optimise.vary", "linkage.crank"),
        ({"vary": ["linkage.coupler = 120:60"]}, "linkage.coupler", "120 to 60"),
        ({"vary": ["kind = 1:2"]}, "kind", "four-bar"),
        ({"minimise": "max(rocker_omeg)"}, "optimise.minimise", "rocker_omega"),
        ({"subject_to": ["rocker_angle"]}, "optimise.subject_to", ">="),
        pytest.param(
            {"subject_to": ["min(transmission_angle) >= 80"]},
            "optimise.subject_to",
            "by 23.4",
            marks=pytest.mark.campaign,
        ),
    ],
)
def test_wrong_entries_of_the_table_are_refused_by_key(changes, field, named):
    with pytest.raises(gk.DesignError) as refused:
        gk.optimise({**FOUR_BAR, "optimise": TABLE | changes}, starts=1)
    assert refused.value.field == field and named in str(refused.value)


def test_a_recipe_without_the_table_says_where_to_give_it(tmp_path):
    for arguments, field in (({}, "vary"), ({"vary": SIDES}, "minimise")):
        with pytest.raises(gk.DesignError) as refused:
            gk.optimise(FOUR_BAR, **arguments)
        assert refused.value.field == field and "[optimise]" in refused.value.remedy
    with pytest.raises(gk.RecipeError) as refused:
        gk.load({**FOUR_BAR, "optimise": TABLE | {"minimise": 3}})
    assert refused.value.problems[0].key == "optimise.minimise"


def test_too_many_combinations_of_whole_numbers_are_refused_before_the_search():
    with pytest.raises(gk.DesignError) as refused:
        pair = {"kind": "gear-pair", "first": {"teeth": 20, "module": 2}, "second": {"teeth": 30, "module": 2}}
        gk.optimise(pair, {"first.teeth": (10, 900), "second.teeth": (10, 900)}, "contact_ratio")
    assert refused.value.id == "too-much-work"


@pytest.mark.campaign
def test_constraint_that_nothing_meets_is_named_with_its_distance():
    """The best transmission angle that these lengths allow is 56.6 deg, 13.4 deg below the limit."""
    with pytest.raises(gk.DesignError) as refused:
        gk.optimise(
            FOUR_BAR,
            SIDES,
            "max(rocker_omega)",
            ["max(rocker_angle) <= 500", "min(transmission_angle) >= 70"],
            starts=1,
        )
    assert "'min(transmission_angle) >= 70' by 13.4" in str(refused.value)


def test_interruption_keeps_the_best_design(monkeypatch, tmp_path):
    """Of the command too, which otherwise ends at Ctrl-C."""
    original, count = Trials.tried, iter(range(1000))

    def tried(self, values):
        if next(count) in (12, 25):
            signal.raise_signal(signal.SIGINT)
        return original(self, values)

    monkeypatch.setattr(Trials, "tried", tried)
    # The tests may have been started where Ctrl-C is ignored, as by `nohup` and `&`.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        best = gk.optimise(FOUR_BAR, SIDES, TRANSMISSION, starts=1)
        assert best.cut_short and best.evaluations == 12
        assert 45 < -best.objective < 56.61
        signal.signal(signal.SIGINT, lambda *_: pytest.fail("the process would end"))
        result = CliRunner().invoke(cli, command(tmp_path))
    finally:
        signal.signal(signal.SIGINT, before)
    assert result.exit_code == 0 and "Ctrl-C" in result.output
    assert (tmp_path / "bar" / "bar.optimum.toml").exists()


def test_a_search_without_time_for_one_design_has_a_reason():
    with pytest.raises(gk.DesignError) as refused:
        gk.optimise(FOUR_BAR, SIDES, TRANSMISSION, time_limit=1e-9)
    assert refused.value.field == "time_limit" and refused.value.problem[-1].isalpha()


def test_time_limit_ends_the_search():
    best = gk.optimise(FOUR_BAR, SIDES, TRANSMISSION, starts=1000, time_limit=0.3)
    assert best.cut_short and best.constraints == ()


def test_command_names_the_time_limit_that_ended_it(monkeypatch, tmp_path):
    assert "time-limit" not in CliRunner().invoke(cli, command(tmp_path)).output
    monkeypatch.setattr(Trials, "over", lambda self: setattr(self, "is_cut", len(self.designs) > 1) or self.is_cut)
    assert "--time-limit 7.5 s" in CliRunner().invoke(cli, [*command(tmp_path), "--time-limit=7.5"]).output


@pytest.mark.parametrize(
    ("recipe", "vary", "minimise", "at_ends"),
    [
        (FOUR_BAR, {"linkage.coupler": (60, 70), "linkage.rocker": (60, 120)}, TRANSMISSION, ("linkage.coupler",)),
        (FOUR_BAR, SIDES, TRANSMISSION, ()),
        (GEAR, {"gear.teeth": (7.5, 12.5)}, "-rim", ("gear.teeth",)),
        (GEAR, {"gear.teeth": (7.5, 12.5)}, "abs(rim - 3.6)", ()),
    ],
)
def test_keys_whose_best_value_is_an_end_of_their_range_are_named(recipe, vary, minimise, at_ends):
    best = gk.optimise(recipe, vary, minimise, starts=1)
    assert best.at_ends == at_ends
    assert at_ends == () or at_ends[0] in best.lines[-1]


@pytest.mark.parametrize(
    "text",
    [
        "__import__('os').system('true')",
        "().__class__",
        "[x for x in (1,)]",
        "lambda: 1",
        "max(rocker_omega, 1)",
        "rocker_omega[0]",
        "open('x')",
        "1j",
        "True",
        "9" * 400,
        "-" * 3000 + "1",
        "(" * 3000 + "1",
        "1" * 20_000,
        "max(\x1b[31m)",
        "",
    ],
    ids=range(15),
)
@pytest.mark.parametrize("field", ["minimise", "subject_to"])
def test_hostile_formulas_are_refused(text, field):
    formulas = {"minimise": TRANSMISSION, "subject_to": (), field: f"{text} <= 1" if field == "subject_to" else text}
    with pytest.raises(gk.DesignError) as refused:
        gk.optimise(FOUR_BAR, VARY, starts=1, **formulas)
    assert refused.value.field == field and str(refused.value).isprintable() and len(str(refused.value)) < 3000


@pytest.mark.campaign
def test_formula_without_a_finite_value_is_refused():
    with pytest.raises(gk.DesignError) as refused:
        gk.optimise(FOUR_BAR | {"drive": {"step_deg": 20}}, VARY, "9**9**9**9 / 0", starts=1)
    assert refused.value.field == "vary"


@pytest.mark.campaign
def test_command_writes_a_recipe_that_holds_the_optimum(tmp_path):
    arguments = command(tmp_path)
    result = CliRunner().invoke(cli, [*arguments, "--subject-to", "max(rocker_angle) <= 170"])
    assert result.exit_code == 0 and "pass" in result.output, result.output
    found = gk.load(tmp_path / "bar" / "bar.optimum.toml")
    assert {check.id: check.value for check in found.checks}["transmission_angle"] > 56
    assert f"{found.design.coupler:.6g}" in result.output
    wrong = CliRunner().invoke(cli, [*arguments, "--vary", "linkage.crank=40"])
    assert wrong.exit_code == 2 and "KEY=LOW:HIGH" in wrong.output
    unmet = CliRunner().invoke(cli, [*arguments, "--subject-to", "min(transmission_angle) >= 70"])
    assert unmet.exit_code == 1 and "min(transmission_angle) >= 70" in unmet.output


def test_pins_of_a_linkage_are_known_to_formulas():
    """The highest position of the rocker's pin that a limit allows."""
    limited = gk.optimise(
        FOUR_BAR, {"linkage.rocker": (60, 90)}, "-max(rocker_pin_y)", "max(rocker_pin_y) <= 65", starts=1
    )
    motion = gk.move(limited.recipe.design, np.radians(np.arange(361)))
    assert motion.point("rocker_pin").position.imag.max() == pytest.approx(65, abs=1e-5)


def test_slider_crank_whose_stroke_is_at_its_bound_everywhere():
    """The stroke is 60 mm for any rod without an offset, so the search stands on its constraint and NLopt may fail there.

    The least peak acceleration is compared with the best of a grid of rods, by second differences of the slider's place.
    """
    recipe = {"kind": "slider-crank", "linkage": {"crank": 30, "coupler": 100, "offset": 0}}
    ranges = {"linkage.coupler": (60, 150), "linkage.offset": (0, 30)}
    best = gk.optimise(recipe, ranges, "max(slide_acceleration)", "range(slide_displacement) >= 60", starts=2)
    angles, step = np.radians(np.arange(360.0)), 1e-3
    rods = np.linspace(60, 150, 901)

    def place(angle):
        return 30 * np.cos(angle) + np.sqrt(rods[:, None] ** 2 - (30 * np.sin(angle)) ** 2)

    second = (place(angles + step) - 2 * place(angles) + place(angles - step)) / step**2
    peaks = (2 * np.pi) ** 2 * second.max(axis=1)  # at 60 rpm
    # The peak of frames 1 deg apart has shallow local minima over the rod's length.
    assert best.objective == pytest.approx(peaks.min(), rel=3e-3)
