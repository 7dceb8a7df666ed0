"""What the chart's page and its progress say of defaults, families and shares of the work."""

import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from click.testing import CliRunner

import geomkin as gk
from geomkin.cli import cli
from geomkin.core.progress import shown
from geomkin.tradeoff import results as measurement
from tests.tradeoff.toy import FAMILY, METHODS, point

# Two methods, of which the second is the default at four settings.
SOME = replace(METHODS[1], name="mine", rationale="it is kept.", caveat="It is safe.")
PAIR = replace(FAMILY, methods=(METHODS[1], replace(METHODS[0], name="other", rationale=""), SOME))


def verdict(*points):
    chart = gk.tradeoff.Chart((gk.tradeoff.FamilyChart(PAIR, points),), False, {}, "")
    page = gk.tradeoff.chart_files(chart)["chart.html"].decode()
    return re.findall("<p>The default is <strong>(.*?)</p>", page)


def test_how_often_a_default_is_on_the_front_is_told_with_all_that_beats_it():
    mine = [
        point("mine", k, error, time) for k, error, time in ((1.0, 0.5, 1e-6), (2.0, 1e-2, 4e-6), (5.0, 1e-4, 8e-6))
    ]
    assert verdict(*mine) == ["mine</strong>: it is kept. It is on the front."]
    # One setting is beaten by two, of which the faster is told; another by one more.
    slower, faster = point("some", 1.0, 1e-3, 3e-6), point("some", 2.0, 9e-3, 2e-6)
    (told,) = verdict(*mine, slower, faster)
    assert told == "mine</strong>: it is kept. It is on the front at 2 of 3: some takes 50% of its time. It is safe."
    (told,) = verdict(*mine, slower, faster, point("other", np.nan, 1e-5, 6e-6))
    assert "on the front at 1 of 3: some takes 50% of its time; other takes 75% of its time. It is safe." in told
    # Of one method it is told once, of the first setting that it beats.
    (told,) = verdict(*mine, faster, point("some", 5.0, 1e-5, 4e-6))
    assert "at 1 of 3: some takes 50% of its time. It is safe." in told
    (told,) = verdict(*mine, point("other", np.nan, 1e-9, 1e-7))
    assert "It is not on the front: other takes 10% of its time. It is safe." in told
    (told,) = verdict(replace(mine[0], missed=0.1), *mine[1:])
    assert "It is on the front at 2 of 3: it misses results. It is safe." in told
    assert verdict(slower, faster) == []


def test_a_time_is_the_least_of_its_batches_and_the_spread_what_the_middle_one_took_longer(monkeypatch):
    """By a clock that only the method moves, each call by another time."""
    now, paces, calls = [0.0], [0.31, 0.2, 0.5, 0.25, 0.8], []
    monkeypatch.setattr(measurement, "time", SimpleNamespace(process_time=lambda: now[0]))
    monkeypatch.setattr(measurement, "FULL", 1.5)

    def call():
        # The first call is not timed but for its results.
        now[0] += paces[(len(calls) - 1) % 5]
        calls.append(0)
        return 0.5

    method = gk.tradeoff.Method("moves", "Takes its time.", lambda problem, setting: call)
    family = replace(FAMILY, methods=(method,), count=lambda problem, found: 10)
    (one,) = measurement.measured(family, False, lambda share: None)
    # 0.31, 0.2, 0.5, 0.25, 0.8: as many as take 1.5 s together.
    assert one.batches == 5 and one.calls == 1 and len(calls) == 6
    assert one.seconds == pytest.approx(0.02) and one.spread == pytest.approx(0.55)


@pytest.fixture
def three(monkeypatch):
    """Three families, and what becomes of each without a clock."""
    families = {name: replace(FAMILY, name=name) for name in ("a", "b", "c")}

    def measured(family, quick, tell):
        tell(0.5)
        tell(1.0)
        return (replace(point("some", 1.0, 0.5, 1e-6), family=family.name),)

    monkeypatch.setattr("geomkin.tradeoff.results.FAMILIES", families)
    monkeypatch.setattr("geomkin.tradeoff.results.measured", measured)
    return families


@pytest.mark.parametrize(("named", "found"), [((), "abc"), (("b",), "b"), (("c", "a", "c"), "ca")])
def test_families_are_measured_in_the_order_in_which_they_are_named_all_where_none_is(three, named, found):
    heard = []
    with shown(lambda share, what: heard.append((round(share * 2 * len(found)), what))):
        chart = gk.tradeoff.chart(named)
    assert [one.family.name for one in chart.families] == list(found) and not chart.quick
    assert heard == [(2 * k + half, f"measuring {name}") for k, name in enumerate(found) for half in (1, 2)]
    assert chart.versions["geomkin"] == gk.__version__ and chart.versions["numpy"] == np.__version__


@pytest.mark.parametrize("watched", [True, False])
def test_the_command_says_how_far_it_is_to_whoever_watches(three, monkeypatch, tmp_path, watched):
    monkeypatch.setattr("geomkin.cli._is_terminal", lambda stream: watched)
    result = CliRunner().invoke(cli, ["chart", "b", "c", "--out", str(tmp_path)], color=True)
    assert result.stdout == f"{tmp_path}/chart: 2 families, 2 points\n" and result.exit_code == 0
    line = "\r\x1b[K"
    told = [f"{line}measuring b: 25%", f"{line}measuring b: 50%", f"{line}measuring c: 75%", line]
    assert result.stderr == ("".join(told) if watched else "")
    assert {path.name for path in (tmp_path / "chart").iterdir()} == {"chart.csv", "chart.html", "b.svg", "c.svg"}


def test_the_study_of_where_methods_break_belongs_to_the_chart_of_all(three, monkeypatch, tmp_path):
    class Study:
        def csv(self):
            return b"study"

        def section(self):
            return "<p>study</p>"

    monkeypatch.setattr("geomkin.tradeoff.study.stability", Study)
    for named, mpmath, has in (([], True, True), (["a"], True, False), ([], None, False)):
        monkeypatch.setattr("importlib.util.find_spec", lambda name, there=mpmath: there)
        folder = tmp_path / f"{len(named)}{mpmath}"
        result = CliRunner().invoke(cli, ["chart", *named, "--out", str(folder)])
        assert result.exit_code == 0 and (folder / "chart/stability.csv").exists() == has
        page = (folder / "chart/chart.html").read_text()
        assert ("<p>study</p>" in page) == ('href="#stability"' in page) == has


def test_the_page_has_both_pictures_of_what_has_a_weight_each_under_its_name():
    family = replace(FAMILY, weighed="bytes & more", weigh=lambda problem, found: 1.0)
    points = [point("all <terms>", np.nan, 1e-3, 4e-6), point("some", 1.0, 0.5, 1e-6), point("some", 2.0, 1e-2, 5e-6)]
    weights = (30.0, 10.0, 20.0)
    one = gk.tradeoff.FamilyChart(family, tuple(replace(p, weight=w) for p, w in zip(points, weights)))
    page = gk.tradeoff.chart_files(gk.tradeoff.Chart((one,), False, {}, ""))["chart.html"].decode()
    pictures = re.findall(r'aria-label="Picture: ([^"]*)">(<svg.*?</svg>)', page, re.DOTALL)
    assert [name for name, _ in pictures] == [
        "Sum of halves &amp; quarters",
        "Sum of halves &amp; quarters, bytes &amp; more",
    ]
    assert [re.findall(r">([^<>]*) per sum</text>", drawn) for _, drawn in pictures] == [
        ["time"],
        ["bytes &amp; more"],
    ]
    # As the files, but for what a file of its own needs.
    files = gk.tradeoff.chart_files(gk.tradeoff.Chart((one,), False, {}, ""))
    for (_, drawn), name in zip(pictures, ("toy-sum.svg", "toy-sum-by-bytes & more.svg")):
        assert drawn.partition(">")[2] in files[name].decode()
    assert "bytes &amp; more" in page and "on the front at 1 of 1" in page
    # Beside it one that weighs nothing has its own picture alone.
    plain = gk.tradeoff.Chart((gk.tradeoff.FamilyChart(FAMILY, tuple(points)),), False, {}, "")
    assert "pays for" not in gk.tradeoff.chart_files(plain)["chart.html"].decode()
