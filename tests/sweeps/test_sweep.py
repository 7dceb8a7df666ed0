"""Sweeps against recipes made one by one, whoever works them out and however often they are stopped."""

import csv
import io
import itertools
import json
import multiprocessing
import threading
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from html.parser import HTMLParser

import numpy as np
import pytest
from click.testing import CliRunner

import geomkin as gk
from geomkin.cli import cli
from geomkin.sweeps import sweep as sweeping

BAR = """kind = "four-bar"
[linkage]
ground = 100
crank = 30
coupler = 90
rocker = 70
[drive]
step_deg = 10
end_deg = 30
"""
CRANKS, ROCKERS = [20, 30, 500], [60.5, 80]
TELL = ["transmission_angle_deg:least", "rocker_angle_deg:last", "grashof_type"]


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "bar.toml"
    path.write_text(BAR)
    return path


def swept(file, out=None, executor=None, values=None):
    values = values or {"linkage.crank": CRANKS, "linkage.rocker": ROCKERS}
    return gk.sweep(file, values, TELL, out, executor)


def rows_of(content):
    return list(csv.DictReader(io.StringIO(content.decode())))


def bytes_of(sweep):
    return {path.name: path.read_bytes() for path in sweep.files}


def test_rows_equal_recipes_made_one_by_one(file, tmp_path):
    sweep = swept(file, tmp_path)
    rows = rows_of(bytes_of(sweep)["bar.sweep.csv"])
    assert len(rows) == len(CRANKS) * len(ROCKERS)
    for row, (crank, rocker) in zip(rows, itertools.product(CRANKS, ROCKERS)):
        assert (float(row["linkage.crank"]), float(row["linkage.rocker"])) == (crank, rocker)
        text = BAR.replace("crank = 30", f"crank = {crank}").replace("rocker = 70", f"rocker = {rocker}")
        try:
            recipe = gk.load(text)
            checks = recipe.checks
        except gk.GeomkinError as error:
            assert (
                crank == 500
                and row["refused"]
                and row["refused"] in str(error)
                and not row["transmission_angle_deg_least"]
            )
            continue
        assert not row["refused"]
        assert row["failed"] == "; ".join(check.id for check in checks if not check.passed)
        for check in checks:
            unit = f"_{check.unit}" if check.unit else ""
            assert float(row[check.id + unit]) == pytest.approx(check.value, rel=1e-8, abs=1e-9)
        column = recipe.table["transmission_angle"]
        if np.isfinite(column).any():
            assert float(row["transmission_angle_deg_least"]) == pytest.approx(np.nanmin(column), rel=1e-8, abs=1e-9)
        last = recipe.table["rocker_angle"][-1]
        assert (
            row["rocker_angle_deg_last"] == ""
            if np.isnan(last)
            else float(row["rocker_angle_deg_last"]) == pytest.approx(last)
        )
        assert row["grashof_type"] == recipe.notes["grashof_type"]


class Backwards(Executor):
    """Does what it was given in the reverse order."""

    def __init__(self):
        self.jobs = []

    def submit(self, function, /, *args, **kwargs):
        future = Future()
        self.jobs.append((future, function, args))
        threading.Timer(0.05, self.work).start()
        return future

    def work(self):
        while self.jobs:
            future, function, args = self.jobs.pop()
            try:
                future.set_result(function(*args))
            except Exception as error:
                future.set_exception(error)


def spawned():
    return ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn"))


@pytest.mark.parametrize(
    "made", [lambda: ThreadPoolExecutor(3), Backwards, pytest.param(spawned, marks=pytest.mark.campaign)]
)
def test_whoever_works_them_out_the_files_are_the_same(file, tmp_path, made):
    alone = bytes_of(swept(file, tmp_path / "alone"))
    with made() as executor:
        assert bytes_of(swept(file, tmp_path / "shared", executor)) == alone


@pytest.mark.campaign
def test_a_cluster_of_dask_gives_the_same_files(file, tmp_path):
    distributed = pytest.importorskip("distributed", reason="pip install -e '.[cluster]'")
    alone = bytes_of(swept(file, tmp_path / "alone"))
    options = {"n_workers": 1, "threads_per_worker": 2, "processes": False, "dashboard_address": None}
    with distributed.LocalCluster(**options) as cluster, distributed.Client(cluster) as client:
        assert bytes_of(swept(file, tmp_path / "shared", client.get_executor())) == alone
        with pytest.raises(gk.DesignError, match="executor"):
            swept(file, None, client)


class Stopping(ThreadPoolExecutor):
    """Fails at the second job that it is given."""

    given = 0

    def submit(self, function, /, *args, **kwargs):
        self.given += 1
        return super().submit(function if self.given < 2 else self.fail, *args, **kwargs)

    @staticmethod
    def fail(*_):
        raise RuntimeError("the lights went out")


@pytest.fixture
def stopped(file, tmp_path):
    """The folder of a sweep that was stopped after its first rows."""
    with Stopping(1) as executor, pytest.raises(gk.DesignError, match="executor:"):
        swept(file, tmp_path / "out", executor)
    assert sorted(path.name for path in (tmp_path / "out/bar").iterdir()) == ["bar.sweep.jsonl"]
    return tmp_path / "out"


@pytest.mark.parametrize("half", ["", '{"key": "[{\\"linkage'])
def test_stopped_sweep_resumes(file, tmp_path, stopped, half, monkeypatch):
    kept = stopped / "bar/bar.sweep.jsonl"
    with kept.open("a") as lines:
        lines.write(half)
    worked = []
    monkeypatch.setattr(sweeping, "evaluate", lambda task, rows: worked.extend(rows) or EVALUATE(task, rows))
    sweep = swept(file, stopped)
    assert (sweep.reused, len(worked), sweep.is_restarted) == (4, 2, False)
    assert bytes_of(sweep) == bytes_of(swept(file, tmp_path / "fresh"))
    assert all(isinstance(json.loads(line), dict) for line in kept.read_text().splitlines())
    assert swept(file, stopped).reused == 6 and len(worked) == 8
    # More values of a key: those that are known are not worked out again.
    assert swept(file, stopped, values={"linkage.crank": [30, 35], "linkage.rocker": ROCKERS}).reused == 2


EVALUATE = sweeping.evaluate


@pytest.mark.campaign
@pytest.mark.parametrize("change", ["recipe", "file", "version", "results"])
def test_changed_sweep_starts_again(tmp_path, change, monkeypatch):
    (tmp_path / "lift.csv").write_text(
        "cam_angle_deg,lift_mm\n" + "".join(f"{k},{10 - 10 * np.cos(np.radians(k)):.3f}\n" for k in range(0, 361, 10))
    )
    text = 'kind = "disk-cam"\n[cam]\nbase_radius = 40\nprogram = [{kind = "table", file = "lift.csv", decimals = 3}]\n[cam.follower]\nkind = "translating-roller"\nroller_radius = 10\n[drive]\nstep_deg = 10\n'
    recipe = tmp_path / "cam.toml"
    recipe.write_text(text)

    def run(results=()):
        sweep = gk.sweep(recipe, {"cam.base_radius": [40, 50]}, results, tmp_path)
        assert not any(row.refused for row in sweep.rows), sweep.rows
        return sweep.reused, sweep.is_restarted

    assert run() == (0, False)
    recipe.write_text(text + "# a remark changes nothing\n")
    assert run() == (2, False)
    if change == "recipe":
        recipe.write_text(text.replace("= 10\n[d", "= 11\n[d"))
    elif change == "version":
        monkeypatch.setattr(sweeping, "__version__", "another")
    elif change == "file":
        (tmp_path / "lift.csv").write_text((tmp_path / "lift.csv").read_text().replace("\n180,20.000", "\n180,20.001"))
    assert run(["lift_mm:largest"] if change == "results" else ()) == (0, True)


def test_invalid_options_are_refused_before_any_work(file, tmp_path):
    for values, results, words in [
        ({"linkage.crnk": [1]}, [], "linkage.crnk"),
        ({"linkge.crank": [1]}, [], "linkge"),
        ({"linkage.crank": [30]}, ["transmission:least"], "results"),
        ({"linkage.crank": [30]}, ["grashof"], "results"),
        ({"linkage.crank": [30]}, ["transmission_angle_deg:lest"], "results"),
        ({"linkage.crank": [float("nan")]}, [], "linkage.crank"),
        ({"linkage.crank": range(10**9)}, [], "linkage.crank"),
        ({}, [], "values"),
    ]:
        with pytest.raises(gk.DesignError) as refusal:
            gk.sweep(file, values, results, tmp_path / "out")
        assert refusal.value.field == words and not (tmp_path / "out").exists()


class Texts(HTMLParser):
    """Rows of a page's table, and what its scripts hold."""

    def __init__(self, page):
        super().__init__()
        self.rows, self.tags, self.data, self.within = [], set(), "", None
        self.feed(page)

    def handle_starttag(self, tag, attributes):
        self.tags.add(tag)
        self.within = "data" if dict(attributes).get("id") == "scene" else tag
        if tag == "tr":
            self.rows.append([])
        if tag in ("td", "th"):
            self.rows[-1].append("")

    def handle_data(self, data):
        if self.within == "data":
            self.data += data
        elif self.within in ("td", "th"):
            self.rows[-1][-1] += data

    def handle_endtag(self, tag):
        self.within = None


def test_the_command_sweeps_resumes_and_says_so(file, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    def run(*arguments):
        result = CliRunner().invoke(cli, ["sweep", "bar.toml", *arguments])
        return result.exit_code, result.stdout, result.stderr

    crank = ("--set", "linkage.crank=20,500", "--result", "transmission_angle_deg:least")
    files = "out/bar/bar.sweep.csv, out/bar/bar.sweep.html"
    assert run(*crank) == (0, f"{files}: 2 combinations, 0 of them reused, 1 refused\n", "")
    first = (tmp_path / "out/bar/bar.sweep.csv").read_bytes()
    assert run(*crank) == (0, f"{files}: 2 combinations, 2 of them reused, 1 refused\n", "")
    assert (tmp_path / "out/bar/bar.sweep.csv").read_bytes() == first
    assert [row["linkage.crank"] for row in rows_of(first)] == ["20", "500"]
    assert "started again" in run(*crank[:2])[2]
    code, _, message = run("--set", "linkage.crank=500,600")
    assert code == 1 and "linkage.crank: found 500 mm" in message
    for arguments, status in (
        (["--set", "linkage.crank=20", "--set", "linkage.crank=30"], 2),
        (["--set", "linkage.crank"], 2),
        (["--set", "linkage.crnk=20"], 1),
        (["--set", "linkage.crank=1:2:1e-9"], 1),
        ([], 2),
    ):
        code, _, message = run(*arguments)
        assert code == status and message
