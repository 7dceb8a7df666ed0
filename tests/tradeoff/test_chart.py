"""The chart's files read back: its table, its pictures, its page; and the command that makes them."""

import csv
import hashlib
import io
import re
import xml.etree.ElementTree as ElementTree
from base64 import b64encode
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from click.testing import CliRunner

import geomkin as gk
from geomkin.cli import cli
from geomkin.core.progress import shown
from geomkin.tradeoff import results as measurement
from geomkin.tradeoff.families import FAMILIES
from geomkin.tradeoff.picture import picture
from tests.tradeoff.toy import CHART, FAMILY, POINTS, point

KEPT = Path(__file__).parent.parent.parent / "tests" / "speed" / "chart"
SVG = "{http://www.w3.org/2000/svg}"
# What a tick's label says, in the axis's unit.
SECONDS = {"ps": 1e-12, "ns": 1e-9, "µs": 1e-6, "ms": 1e-3, "s": 1.0, "ks": 1e3, "": 1.0}
POWERS = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")
FRONT = [True, True, True, False, True, False, False]


def rows(content):
    return list(csv.DictReader(io.StringIO(content.decode())))


def test_the_table_has_every_point():
    told = rows(gk.tradeoff.chart_files(CHART)["chart.csv"])
    assert [row["method"] for row in told] == [p.method for p in POINTS]
    assert [row["on_front"] for row in told] == [str(int(on)) for on in FRONT]
    assert [row["default"] for row in told] == ["1", "0", "0", "0", "0", "0", "0"]
    for row, p in zip(told, POINTS):
        numbers = [
            float(row[name] or "nan") for name in ("setting", "largest_error", "rms_error", "seconds_per_result")
        ]
        assert numbers == pytest.approx([p.setting, p.largest, p.rms, p.seconds], nan_ok=True)
        assert (row["calls_per_batch"], row["batches"], row["missed_share"]) == ("10", "3", f"{p.missed:g}")
        assert (row["setting_name"], row["per"], row["error_unit"]) == ("terms" * (p.method == "some"), "sum", "mm")
        assert (row["geomkin_version"], row["processor"]) == ("0", "a <processor>")


def place(element):
    return [float(v) for v in re.findall(r"-?[\d.]+", element.get("transform"))]


def axis(root, across):
    """From a place in the picture to what the axis says there, by its labels."""
    found = []
    for label in root.iter(f"{SVG}text"):
        text = label.text or ""
        if across and (match := re.fullmatch(r"([\d,]+) ?(ps|ns|µs|ms|s|ks|)", text)):
            if label.get("text-anchor") == "middle":
                found.append((float(label.get("x")), float(match[1].replace(",", "")) * SECONDS[match[2]]))
        elif not across and label.get("text-anchor") == "end":
            power = re.fullmatch(r"10([⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)", text)
            found.append((float(label.get("y")), 10.0 ** int(power[1].translate(POWERS)) if power else float(text)))
    (a, first), (b, last) = found[0], found[-1]
    assert len(found) > 2 and first != last
    return lambda at: first * (last / first) ** ((at - a) / (b - a))


def test_the_picture_shows_every_point_where_its_axes_say_it_is():
    root = ElementTree.fromstring(gk.tradeoff.chart_files(CHART)["toy-sum.svg"])
    time, error = axis(root, True), axis(root, False)
    marks = [m for m in root.iter(f"{SVG}path") if m.get("class") == "point"]
    seen = [p for p in POINTS if np.isfinite(p.largest)]
    assert len(marks) == len(seen)
    (frame,) = [p.get("d") for p in root.iter(f"{SVG}path") if re.fullmatch(r"M\d+ \d+V\d+H\d+", p.get("d"))]
    left, top, bottom, right = map(int, re.findall(r"\d+", frame))
    ticks = [float(t.get("x")) for t in root.iter(f"{SVG}text") if re.fullmatch(r"\d+ (ps|ns|µs)", t.text or "")]
    assert min(ticks) == left and max(ticks) <= right
    for mark, p, on in zip(marks, seen, (*FRONT[:5], False)):
        x, y = place(mark)
        assert left < x < right and top < y < bottom
        # To the rounding of a place, a twentieth of a unit, and what counts as rounding is shown as that.
        assert time(x) == pytest.approx(p.seconds, rel=0.01)
        assert error(y) == pytest.approx(max(p.largest, 1e-15), rel=0.02)
        assert (mark.get("fill") != "#fff") == on
        assert p.method in mark.find(f"{SVG}title").text
    rings = [place(ring) for ring in root.iter(f"{SVG}circle") if ring.get("transform")]
    assert rings == [place(marks[0])]
    words = " ".join(root.itertext())
    assert {"time per sum", "largest error, mm", "Sum of halves & quarters"} <= {t.strip() for t in words.split("\n")}


@pytest.mark.parametrize("decades", [(-8, 4)])
@pytest.mark.parametrize("weighed", [False, True])
def test_axes_match_points(decades, weighed):
    costs = np.geomspace(*(2.0 * 10.0**power for power in decades), len(POINTS))
    errors = np.geomspace(3e4, 2e-6, len(POINTS))
    points = [
        replace(p, seconds=1e-3 if weighed else cost, weight=1e12 * cost, largest=error)
        for p, cost, error in zip(POINTS, costs.tolist(), errors.tolist())
    ]
    family = replace(FAMILY, weighed="bytes", weigh=lambda problem, found: 1.0)
    made = gk.tradeoff.chart_files(replace(CHART, families=(gk.tradeoff.FamilyChart(family, tuple(points)),)))
    root = ElementTree.fromstring(made["toy-sum-by-bytes.svg" if weighed else "toy-sum.svg"])
    across, upwards = axis(root, True), axis(root, False)
    marks = [m for m in root.iter(f"{SVG}path") if m.get("class") == "point"]
    for mark, p in zip(marks, points, strict=True):
        x, y = place(mark)
        assert across(x) == pytest.approx(p.weight if weighed else p.seconds, rel=0.02)
        assert upwards(y) == pytest.approx(p.largest, rel=0.02)
    words = [label.text for label in root.iter(f"{SVG}text")]
    assert ("bytes per sum" if weighed else "time per sum") in words
    # Of a method's points a line goes through all, in their order; the ticks are no more than fit.
    (tied,) = [p.get("d") for p in root.iter(f"{SVG}path") if p.get("stroke-dasharray") and p.get("d").count("L") == 3]
    assert [float(v) for v in re.findall(r"[\d.]+", tied)] == [v for m in marks[1:5] for v in place(m)]
    ticks = [t for t in root.iter(f"{SVG}text") if t.get("text-anchor") == "middle" and re.match(r"\d", t.text or "")]
    assert 3 <= len(ticks) <= 7


def test_marks_of_different_methods_differ_in_form_and_the_front_goes_through_its_points():
    root = ElementTree.fromstring(gk.tradeoff.chart_files(CHART)["toy-sum.svg"])
    marks = [m for m in root.iter(f"{SVG}path") if m.get("class") == "point"]
    assert len({m.get("d") for m in marks}) == 3 == len({m.get("stroke") for m in marks})
    (front,) = [p.get("d") for p in root.iter(f"{SVG}path") if p.get("class") == "front"]
    steps = re.findall(r"H([\d.]+)V([\d.]+)", front)
    on = sorted(place(m) for m, shown in zip(marks, FRONT) if shown)
    assert [[float(x), float(y)] for x, y in steps] == on


@pytest.mark.parametrize(("least", "most"), [(3e-15, 2e-11), (0.2, 4e6)])
def test_axis_labels(least, most):
    """Thousandths and thousands of a second by their prefixes; errors by powers of ten far from 1, plain near it."""
    points = tuple(point("some", float(k), value, value) for k, value in enumerate((least, most)))
    one = gk.tradeoff.FamilyChart(replace(FAMILY, floor=1e-20, weighed="bytes", weigh=len), points)
    heavy = tuple(replace(p, weight=max(1.0, p.seconds * 1e3)) for p in points)
    for family, weighed in ((one, False), (replace(one, points=heavy), True)):
        root = ElementTree.fromstring(picture(family, weighed))
        labels = [
            t
            for t in root.iter(f"{SVG}text")
            if re.match(r"[\d,.]+(e\+\d+)?( [pnµmk]?s|[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)?$", t.text or "")
        ]
        across = {t.text: float(t.get("x")) for t in labels if t.get("text-anchor") == "middle"}
        upwards = {t.text: float(t.get("y")) for t in labels if t.get("text-anchor") == "end"}
        for told in (across, upwards):
            # Evenly by powers of ten, at most as many as fit.
            values, places = [value(one) for one in told], list(told.values())
            steps = np.diff(np.log10(values))
            assert 2 <= len(told) <= 11 and steps == pytest.approx(np.full(len(steps), np.round(steps[0])), abs=1e-9)
            assert np.diff(places) == pytest.approx(np.full(len(steps), places[1] - places[0]), abs=0.11)
        if weighed:
            assert all(one == (f"{v:,.0f}" if (v := value(one)) >= 1 else f"{v:g}") for one in across)
        else:
            assert all(1 <= float(one.split()[0]) < 1000 for one in across if one[-2:] not in ("ps", "ks"))
        assert all(POWERS.keys().isdisjoint(map(ord, one)) == (5e-4 < value(one) < 5e3) for one in upwards)


def value(label):
    """What a label says, in seconds where it is a time."""
    power = re.fullmatch(r"10([⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)", label)
    number, _, unit = label.partition(" ")
    return 10.0 ** int(power[1].translate(POWERS)) if power else float(number.replace(",", "")) * SECONDS[unit]


@pytest.mark.parametrize("many", [1, 15])
def test_legend_stays_within_picture(many):
    """Row below row, none on another, the last of its words above the lower edge, beside the axes."""
    methods = tuple(replace(FAMILY.methods[1], name=f"way {k}") for k in range(many))
    points = tuple(point(m.name, setting, 0.5, 1e-6) for m in methods for setting in m.settings)
    one = gk.tradeoff.FamilyChart(replace(FAMILY, methods=methods), points)
    root = ElementTree.fromstring(gk.tradeoff.chart_files(replace(CHART, families=(one,)))["toy-sum.svg"])
    width, height = map(float, root.get("viewBox").split()[2:])
    (frame,) = [p.get("d") for p in root.iter(f"{SVG}path") if re.fullmatch(r"M\d+ \d+V\d+H\d+", p.get("d"))]
    _, top, bottom, right = map(int, re.findall(r"\d+", frame))
    told = [t for t in root.iter(f"{SVG}text") if t.get("dy") == "4" and float(t.get("x")) > right]
    rows = [float(t.get("y")) for t in told]
    assert len(rows) == many + 3 and min(np.diff(rows)) >= 19 and top < rows[0] and rows[-1] < height - 20
    assert 20 < height - bottom < 80 and right < width - 200
    # Words of the axis stand below its numbers, and within.
    below = sorted(
        {float(t.get("y")) for t in root.iter(f"{SVG}text") if t.get("text-anchor") == "middle" and t.get("y")}
    )
    assert len(below) == 2 and bottom + 12 < below[0] < below[1] - 12 < height - 16


class Outline(HTMLParser):
    """Tags and words of a page."""

    def __init__(self):
        super().__init__()
        self.tags, self.words = [], []

    def handle_starttag(self, tag, attributes):
        self.tags.append((tag, dict(attributes)))

    def handle_data(self, data):
        self.words.append(data)


def test_page_runs_no_script_and_escapes_names():
    content = gk.tradeoff.chart_files(CHART)["chart.html"].decode()
    page = Outline()
    page.feed(content)
    kinds = [tag for tag, _ in page.tags]
    assert "script" not in kinds and kinds.count("h1") == 1 and "terms" not in kinds and "processor" not in kinds
    style = re.search("<style>(.*)</style>", content, re.DOTALL)[1]
    policy = next(a["content"] for tag, a in page.tags if tag == "meta" and "http-equiv" in a)
    assert b64encode(hashlib.sha256(style.encode()).digest()).decode() in policy and "default-src 'none'" in policy
    assert not any("style" in a or any(key.startswith("on") for key in a) for _, a in page.tags)
    assert " ".join(page.words).count("10 calls") == len(POINTS)


def test_front_goes_by_six_digits():
    """The front goes by six digits, and so does what a default off it is beaten by."""
    one = replace(FAMILY, methods=(FAMILY.methods[1], replace(FAMILY.methods[0], caveat="It is safe.")))
    for beats, default in (
        (point("some", 1.0, 1e-5 * (1 + 1e-9), 2e-6), point("all <terms>", np.nan, 1e-5, 4e-6)),
        (point("some", 1.0, 1e-5, 4e-6 * (1 + 1e-9)), point("all <terms>", np.nan, 2e-5, 4e-6)),
    ):
        family = gk.tradeoff.FamilyChart(one, (beats, default))
        assert family.on_front.tolist() == [True, False]


def test_quick_measurement(monkeypatch):
    monkeypatch.setattr("geomkin.tradeoff.results.FAMILIES", {"toy-sum": FAMILY})
    monkeypatch.setattr("geomkin.tradeoff.results.QUICK", 0.02)
    told = []
    with shown(lambda share, what: told.append((share, what))):
        (one,) = gk.tradeoff.chart(["toy-sum"], quick=True).families
    assert told[-1] == (1.0, "measuring toy-sum") and sorted(told) == told
    # In a hurry the first, the middle and the last setting, and nothing slow.
    assert [(p.method, p.setting) for p in one.points[1:]] == [("some", 1.0), ("some", 5.0), ("some", 10.0)]
    assert [p.rms for p in one.points] == pytest.approx([p.largest / 2**0.5 for p in one.points])
    assert [p.largest for p in one.points] == pytest.approx([0.0, 0.5, 0.5**5, 0.5**10], abs=1e-15)
    assert all(p.seconds > 0 and p.batches >= 3 and p.calls >= 1 and p.results == 1 for p in one.points)


@pytest.mark.parametrize("quick", [False, True])
def test_batches_last_their_time(quick, monkeypatch):
    """By a clock that only the methods move: seconds, calls and batches are then known."""
    now, costs, order = [0.0], {1.0: 1e-6, 2.0: 3e-4, 5.0: 0.05, 10.0: 0.4}, []
    monkeypatch.setattr(measurement, "time", SimpleNamespace(process_time=lambda: now[0]))

    def make(problem, setting):
        def call():
            now[0] += costs[setting]
            if not order or order[-1] != setting:
                order.append(setting)
            return 0.25 if setting < 10 else float("nan")

        return call

    method = gk.tradeoff.Method("moves", "Takes its time.", make, "terms", tuple(costs))
    family = replace(
        FAMILY,
        methods=(method, replace(method, name="slow", slow=True)),
        count=lambda problem, found: 4,
        error=lambda problem, found: np.array([found - 1, 0.75, np.inf, 0.0]) * [-1, 1, 1, 1] + 0 * found,
        weighed="bytes",
        weigh=lambda problem, found: 8 * found,
    )
    shares = []
    found = measurement.measured(family, quick, shares.append)
    settings = [1.0, 5.0, 10.0] if quick else list(costs)
    assert [p.method for p in found] == ["moves"] * len(settings) + ["slow"] * len(settings) * (not quick)
    assert [p.setting for p in found[: len(settings)]] == settings
    # Each is made, then timed once, then in rounds: no step looks as if nothing went on.
    made, timed = np.linspace(0, 0.3, len(found) + 1)[1:], np.linspace(0.3, 0.5, len(found) + 1)[1:]
    assert shares[: 2 * len(found)] == pytest.approx([*made, *timed]) and shares == sorted(shares) and shares[-1] == 1
    rounds = np.array(shares[2 * len(found) :])
    assert len(rounds) > 3 and rounds.min() > 0.5 and np.diff(rounds).max() < 0.3
    for p in found:
        cost, budget = costs[p.setting], measurement.QUICK / len(found) if quick else measurement.FULL
        assert p.seconds == pytest.approx(cost / 4) and p.results == 4 and p.spread == pytest.approx(0, abs=1e-6)
        assert p.weight == pytest.approx(2.0 if p.setting < 10 else np.nan, nan_ok=True)
        assert p.missed == (0.25 if p.setting < 10 else 1)
        known = (0.75, np.sqrt(0.375)) if p.setting < 10 else (np.nan, np.nan)
        assert (p.largest, p.rms) == pytest.approx(known, nan_ok=True)
        # A batch can be timed, and no point has more of them than its time, or three, take.
        spent, batch = p.calls * cost * p.batches, p.calls * cost
        assert batch >= measurement.BATCH or cost > measurement.LONG
        assert p.calls == 1 or batch < 2.1 * measurement.BATCH
        if quick and cost > measurement.LONG:
            assert p.batches == p.calls == 1
        else:
            assert p.batches >= 3 and spent > budget - 1e-9 and (p.batches == 3 or spent < budget + 1.001 * batch)
    # All are gone round, not one after the other.
    assert len(order) > 3 * len(settings)


def test_unknown_family_is_refused(tmp_path):
    result = CliRunner().invoke(cli, ["chart", "four-bars", "--out", str(tmp_path / "made")])
    assert result.exit_code == 2 and all(name in result.stderr for name in FAMILIES) and not list(tmp_path.iterdir())
    with pytest.raises(gk.DesignError):
        gk.tradeoff.chart(["four-bars"])


def test_the_command_writes_the_files(tmp_path, monkeypatch):
    monkeypatch.setattr("geomkin.tradeoff.results.FAMILIES", {"toy-sum": FAMILY})
    monkeypatch.setattr("geomkin.tradeoff.results.QUICK", 0.02)
    result = CliRunner().invoke(cli, ["chart", "toy-sum", "--quick", "--out", str(tmp_path / "made")])
    assert result.exit_code == 0 and result.stdout.endswith("made/chart: 1 family, 4 points\n")
    names = {path.name for path in (tmp_path / "made" / "chart").iterdir()}
    assert names == {"chart.csv", "chart.html", "toy-sum.svg"}


@pytest.mark.campaign
def test_the_quick_chart_of_everything(tmp_path):
    assert CliRunner().invoke(cli, ["chart", "--quick", "--out", str(tmp_path)]).exit_code == 0
    told = rows((tmp_path / "chart" / "chart.csv").read_bytes())
    assert {row["family"] for row in told} == set(FAMILIES)


def test_kept_chart_defaults_are_on_front_or_justified():
    told = rows((KEPT / "chart.csv").read_bytes())
    assert {row["family"] for row in told} == set(FAMILIES), "make it anew: geomkin chart --out ."
    for name, family in FAMILIES.items():
        points = [row for row in told if row["family"] == name]
        methods = {method.name: method for method in family.methods}
        assert {row["method"] for row in points} == set(methods)
        defaults = [row for row in points if row["default"] == "1"]
        assert defaults and {row["method"] for row in defaults} == {n for n, m in methods.items() if m.is_default}
        for row in defaults:
            assert row["on_front"] == "1" or methods[row["method"]].caveat, row
        # What the file says of the front is what its numbers say.
        errors = [max(float(row["largest_error"] or "nan"), family.floor) for row in points]
        errors = [np.nan if float(row["missed_share"]) else error for row, error in zip(points, errors)]
        front = gk.tradeoff.pareto_front([float(row["seconds_per_result"]) for row in points], errors)
        assert [row["on_front"] == "1" for row in points] == front.tolist()


def test_single_results_are_counted_as_one():
    single = {"file", "profile", "curve", "space", "side of a tooth"}
    found = {family.per: family.count(None, None) for family in FAMILIES.values() if family.per in single}
    assert found == dict.fromkeys(single, 1)


def test_time_is_least_of_batches_and_spread_the_median(monkeypatch):
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
def test_order_of_families(three, named, found):
    heard = []
    with shown(lambda share, what: heard.append((round(share * 2 * len(found)), what))):
        chart = gk.tradeoff.chart(named)
    assert [one.family.name for one in chart.families] == list(found) and not chart.quick
    assert heard == [(2 * k + half, f"measuring {name}") for k, name in enumerate(found) for half in (1, 2)]
    assert chart.versions["geomkin"] == gk.__version__ and chart.versions["numpy"] == np.__version__


def test_stability_study_belongs_to_full_chart(three, monkeypatch, tmp_path):
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
