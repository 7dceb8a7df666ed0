"""What a sweep is called, what it says while it works, what a run goes on with, and who works out what."""

from concurrent.futures import Executor, Future

import pytest

import geomkin as gk
from geomkin.core import processes
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
        (lambda: gk.load(BAR).with_name("mine"), "mine"),
    ],
    ids=["file", "text", "recipe with a name"],
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
    assert gk.sweep(source(), ONE, (), "made").reused == 1 and gk.sweep(source(), ONE).files == {}


class Failing(Executor):
    """Works its first job at once, fails at the second, and leaves later ones undone."""

    def __init__(self):
        self.given, self.undone = [], []

    def submit(self, work, batch):
        future = Future()
        self.given.append(batch)
        if len(self.given) == 1:
            future.set_result(work(batch))
        elif len(self.given) == 2:
            future.set_exception(RuntimeError("out of light"))
        else:
            self.undone.append(future)
        return future


def test_results_are_kept_and_waiting_work_is_cancelled_on_failure(here, monkeypatch):
    monkeypatch.setattr(processes, "MOST_WAITING", 4)
    failing = Failing()
    # Of the first four jobs one works, the second fails, the others wait without end.
    with pytest.raises(gk.DesignError) as refusal:
        gk.sweep(TABLE, {"linkage.crank": [10 + k for k in range(30)]}, (), "made", failing)
    assert refusal.value.field == "executor" and "out of light" in refusal.value.problem
    assert len(failing.given) in (4, 5) and failing.undone and all(one.cancelled() for one in failing.undone)
    assert gk.sweep(TABLE, {"linkage.crank": [10, 11, 12, 13]}, (), "made").reused == 4


def test_refusal_keeps_its_type_through_an_executor(here):
    class Refusing(Executor):
        def submit(self, *_):
            raise gk.DesignError("crank", "found 1", "give 2")

    with pytest.raises(gk.DesignError, match="^crank:"):
        gk.sweep(TABLE, ONE, (), None, Refusing())


def test_a_slip_in_one_of_several_keys_is_reported_at_once_and_the_recipe_s_own_in_its_rows(here):
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
