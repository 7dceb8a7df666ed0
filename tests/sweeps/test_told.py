"""What a sweep is called, what it says while it works, what a run goes on with, and who works out what."""

from concurrent.futures import Executor, Future
from types import SimpleNamespace

import numpy as np
import pytest
from click.testing import CliRunner

import geomkin as gk
from geomkin.cli import cli
from geomkin.core.progress import shown
from geomkin.model.table import Column, Table
from geomkin.sweeps import row as of_one
from geomkin.sweeps import sweep as sweeping
from tests.sweeps.test_sweep import BAR

SIZES = {"ground": 100, "crank": 30, "coupler": 90, "rocker": 70}
TABLE = {"kind": "four-bar", "linkage": SIZES, "drive": {"step_deg": 90}}
ONE = {"linkage.crank": [20]}


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "in").mkdir()
    (tmp_path / "in/bar 7.toml").write_text(BAR)
    return tmp_path


@pytest.mark.parametrize(
    ("source", "name"),
    [
        (lambda: "in/bar 7.toml", "bar 7"),
        (lambda: BAR, "four-bar"),
        (lambda: TABLE, "four-bar"),
        (lambda: gk.load("in/bar 7.toml"), "bar 7"),
        (lambda: gk.load(BAR), "four-bar"),
        (lambda: gk.load(BAR).with_name("mine"), "mine"),
    ],
    ids=["file", "text", "table", "recipe of a file", "recipe", "recipe called"],
)
def test_a_sweep_is_called_as_its_recipe_is(here, source, name):
    found = gk.sweep(source(), ONE, (), "made")
    assert found.name == name
    assert sorted(path.as_posix() for path in found.files) == [
        f"made/{name}/{name}.sweep.{end}" for end in ("csv", "html")
    ]
    for path, size in found.files.items():
        assert path.stat().st_size == size > 100
    assert f"<title>{name}: a sweep</title>" in (here / f"made/{name}/{name}.sweep.html").read_text()
    assert gk.sweep(source(), ONE, (), "made").kept == 1 and gk.sweep(source(), ONE).files == {}


def test_a_recipe_whose_tables_stand_in_another_order_is_the_same(here):
    gk.sweep(TABLE, ONE, (), "made")
    turned = {"drive": {"step_deg": 90}, "linkage": dict(reversed(SIZES.items())), "kind": "four-bar"}
    again = gk.sweep(turned, ONE, (), "made")
    assert (again.kept, again.anew) == (1, False)
    other = gk.sweep(TABLE | {"drive": {"step_deg": 45}}, ONE, (), "made")
    assert (other.kept, other.anew) == (0, True)
    # Names that are told twice are told once.
    assert gk.sweep(TABLE, ONE, ["grashof_type", "grashof_type"]).rows[0].told == {"grashof_type": "crank-rocker"}


def test_keys_in_another_order_are_the_same_combinations(here):
    both = {"linkage.crank": [20, 25], "linkage.rocker": [70, 75]}
    gk.sweep(TABLE, both, (), "made")
    again = gk.sweep(TABLE, dict(reversed(both.items())), (), "made")
    assert again.kept == 4 and again.keys == ("linkage.rocker", "linkage.crank")
    assert [tuple(row.values.values()) for row in again.rows] == [(70, 20), (70, 25), (75, 20), (75, 25)]


def test_a_sweep_says_how_many_of_its_combinations_are_done(here):
    told = []
    with shown(lambda share, what: told.append((share, what))):
        gk.sweep(TABLE, {"linkage.crank": [20, 25]}, (), "made")
        gk.sweep(TABLE, {"linkage.crank": [20, 22, 24, 25, 26]}, (), "made")
    assert told == [
        (0.5, "1 of 2 combinations"), (1.0, "2 of 2 combinations"),
        (0.6, "3 of 5 combinations"), (0.8, "4 of 5 combinations"), (1.0, "5 of 5 combinations"),
    ]  # fmt: skip


@pytest.mark.parametrize("watched", [True, False])
def test_the_command_tells_whoever_watches_and_why_all_are_refused(here, monkeypatch, watched):
    monkeypatch.setattr("geomkin.cli._is_terminal", lambda stream: watched)

    def run(*values):
        result = CliRunner().invoke(cli, ["sweep", "in/bar 7.toml", *values], color=True)
        return result.exit_code, result.stdout, result.stderr

    line = "\r\x1b[K"
    halves = f"{line}4 of 6 combinations: 67%{line}" if watched else ""
    code, _, told = run("--set", "linkage.crank=20,22,24,25,26,500")
    assert (code, told) == (0, halves)
    # One that is refused, of one.
    code, out, told = run("--set", " linkage.crank =500")
    assert code == 1 and out.endswith(": 1 combinations, 1 of them from before, 1 refused\n")
    assert "all are refused, the first for this: linkage" in told and line not in told


class Failing(Executor):
    """Works its first job at once, fails at the second, and leaves later ones undone."""

    def __init__(self):
        self.given, self.undone = [], []

    def submit(self, work, task, batch):
        future = Future()
        self.given.append(batch)
        if len(self.given) == 1:
            future.set_result(work(task, batch))
        elif len(self.given) == 2:
            future.set_exception(RuntimeError("out of light"))
        else:
            self.undone.append(future)
        return future


class Late(Executor):
    """Is done with a job when it is given the next but one, with all when it is given the last."""

    def __init__(self, last):
        self.last, self.given, self.jobs, self.handed, self.most = last, [], [], 0, 0

    def submit(self, work, task, batch):
        self.given.append(batch)
        self.most = max(self.most, len(self.given) - self.handed)
        self.jobs.append((Future(), work, task, batch))
        future = self.jobs[-1][0]
        while len(self.jobs) > (0 if batch[-1] == self.last else 2):
            done, *job = self.jobs.pop(0)
            done.set_result(job[0](*job[1:]))
        return future

    def tell(self, share, what):
        self.handed += 1


def test_an_executor_is_given_four_at_a_time_and_never_more_jobs_than_there_may_wait(here, monkeypatch):
    def worked_out(task, several):
        return [{"refused": f"no {one}", "checks": [], "told": {}} for one in several]

    monkeypatch.setattr(sweeping, "AHEAD", 3)
    monkeypatch.setattr(sweeping, "worked_out", worked_out)
    values = {"linkage.crank": list(range(20, 38))}
    late = Late({"linkage.crank": 37})
    with shown(late.tell):
        found = gk.sweep(TABLE, values, (), None, late)
    assert [len(batch) for batch in late.given] == [4, 4, 4, 4, 2] and late.most == 3
    assert [one["linkage.crank"] for batch in late.given for one in batch] == values["linkage.crank"]
    assert [row.refused for row in found.rows] == [f"no {{'linkage.crank': {k}}}" for k in values["linkage.crank"]]


def test_what_was_found_is_handed_on_before_what_went_wrong_and_what_waits_is_called_off(here, monkeypatch):
    monkeypatch.setattr(sweeping, "AHEAD", 4)
    failing = Failing()
    # Of the first four jobs one works, the second fails, the others wait without end.
    with pytest.raises(gk.DesignError) as refusal:
        gk.sweep(TABLE, {"linkage.crank": [10 + k for k in range(30)]}, (), "made", failing)
    assert refusal.value.field == "executor" and refusal.value.problem == "it failed (RuntimeError: out of light)"
    assert refusal.value.remedy == "give one that works; with `out`, what was found is kept"
    assert len(failing.given) in (4, 5) and failing.undone and all(one.cancelled() for one in failing.undone)
    assert gk.sweep(TABLE, {"linkage.crank": [10, 11, 12, 13]}, (), "made").kept == 4


def test_a_refusal_of_ours_in_an_executor_stays_what_it_is(here):
    class Refusing(Executor):
        def submit(self, *_):
            raise gk.DesignError("crank", "found 1", "give 2")

    with pytest.raises(gk.DesignError, match="^crank: found 1; give 2$"):
        gk.sweep(TABLE, ONE, (), None, Refusing())


@pytest.mark.parametrize("seed", range(12))
def test_of_a_column_with_gaps_least_and_largest_are_found_and_the_last_is_the_last_row_s_own(seed):
    numbers = np.random.default_rng(seed)
    values = np.where(numbers.random(5) < 0.4, np.nan, numbers.normal(size=5))
    recipe = SimpleNamespace(table=Table((Column("a", "mm", "", np.arange(5.0)), Column("b", "mm", "", values))))
    known = [value for value in values.tolist() if value == value]
    assert of_one._told(recipe, "b_mm:least") == min(known, default=None)
    assert of_one._told(recipe, "b_mm:largest") == max(known, default=None)
    last = values.tolist()[-1]
    assert of_one._told(recipe, "b_mm:last") == (last if last == last else None)
    assert of_one._told(recipe, "c_mm:last") is None


@pytest.mark.parametrize(
    ("source", "words"),
    [
        (lambda: gk.load(BAR).with_name("con"), "con: (whole file): its name cannot name a folder and files: Windows"),
        (lambda: {"kind": "con"}, "recipe: (whole file): its name cannot name"),
        (lambda: 'kind = "a/b"\n', "recipe: (whole file): its name cannot name"),
        (lambda: "in/aux.toml", "in/aux.toml: (whole file): its name cannot name"),
    ],
)
def test_what_cannot_name_files_is_refused_under_what_it_came_from(here, source, words):
    (here / "in/aux.toml").write_text(BAR)
    with pytest.raises(gk.RecipeError) as refusal:
        gk.sweep(source(), ONE)
    assert str(refusal.value).startswith(words)


def test_a_slip_in_one_of_several_keys_is_told_at_once_and_the_recipe_s_own_in_its_rows(here):
    good = {"linkage.crank": [20, 25]}
    for key, found in (("linkage.crnk", "linkage.crnk"), ("shaft.bore", "shaft"), ("odd[0]", "odd"), ("odd", "odd")):
        for values in ({**good, key: [1]}, {key: [1], **good}):
            with pytest.raises(gk.DesignError) as refusal:
                gk.sweep(TABLE | ({"odd": [1, 2]} if "odd" in key else {}), values, (), "made")
            assert (refusal.value.field, refusal.value.problem) == (found, "unknown key")
    assert not (here / "made").exists()
    # A key that only begins like one that was asked for is the recipe's own slip.
    table = TABLE | {"linkage": SIZES | {"cra": 3}}
    rows = gk.sweep(table, good).rows
    assert len(rows) == 2 and all(row.refused.startswith("linkage.cra: unknown key") for row in rows)


def test_names_to_tell_of_are_judged_by_the_first_recipe_that_works(here):
    first = [500.0 + k for k in range(19)]
    rows = gk.sweep(TABLE, {"linkage.crank": [*first, 30]}, ["grashof_type"]).rows
    assert [row.told.get("grashof_type") for row in rows[-2:]] == [None, "crank-rocker"]
    with pytest.raises(gk.DesignError, match="tell: found 'grashof'"):
        gk.sweep(TABLE, {"linkage.crank": [*first, 30]}, ["grashof"])
    # Where none works at all, there is nothing to judge them by.
    assert all(row.refused for row in gk.sweep(TABLE, {"linkage.crank": first}, ["grashof"]).rows)


@pytest.mark.parametrize("name", ["a.csv", "long" * 40 + ".csv", "in/b.csv"])
def test_a_file_that_a_value_names_is_part_of_the_value(here, name):
    (here / name).write_text("1")
    before = of_one.file_marks({"x": [name]}, str(here))
    (here / name).write_text("2")
    assert len(before) == 1 and before != of_one.file_marks({"x": [name]}, str(here))


@pytest.mark.parametrize(
    ("notes", "told"),
    [({}, ""), ({"a": 1, "b": {"c": "x", "d": [1]}, "e": None}, ", or one of a, b.c"), ({"d": [1]}, "")],
)
def test_what_may_be_told_is_listed_where_there_is_any(notes, told):
    recipe = SimpleNamespace(
        table=Table((Column("t", "s", "", np.arange(2.0)), Column("n", "", "", np.array(["x", "y"])))), notes=notes
    )
    for name in ("zzz", "t_s:most"):
        with pytest.raises(gk.DesignError) as refusal:
            of_one.check_tell(of_one.Task({}, "", "", (name,)), recipe)
        assert refusal.value.remedy == f"give COLUMN:least, COLUMN:largest, COLUMN:last{told}"
    # Columns of text have no least.
    for name in ("n:least", "zzz:last"):
        with pytest.raises(gk.DesignError, match="give columns: t$"):
            of_one.check_tell(of_one.Task({}, "", "", (name,)), recipe)
    known = ("t_s:last", "t:least", *(name for name in ("a", "b.c") if "a" in notes))
    of_one.check_tell(of_one.Task({}, "", "", known), recipe)


def test_an_entry_may_be_called_as_a_way_to_tell_of_a_column_is():
    table = Table((Column("t", "s", "", np.arange(2.0)),))
    recipe = SimpleNamespace(table=table, notes={"last": 5, "t_s:most": 6, ":least": 7})
    found = [of_one._told(recipe, name) for name in ("last", "t_s:most", "t_s:last", "least", ":")]
    assert found == [5, 6, 1.0, None, None]
    of_one.check_tell(of_one.Task({}, "", "", ("last", "t_s:most")), recipe)
