"""The chart's files read back: its table, its pictures, its page; and the command that makes them."""

import csv
import hashlib
import html
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
from geomkin.tradeoff import results
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


@pytest.mark.parametrize("decades", [(-11, -6), (-8, 4), (-3, 1), (0, 4)])
@pytest.mark.parametrize("weighed", [False, True])
def test_axes_of_any_span_tell_where_points_are(decades, weighed):
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
        setting = f" (terms {p.setting:g})" if p.method == "some" else ""
        cost = f"{p.weight:g} bytes" if weighed else f"{p.seconds:.2g} s"
        assert mark.find(f"{SVG}title").text == f"{p.method}{setting}: {cost} per sum, error {p.largest:.2g}"
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


@pytest.mark.parametrize(("least", "most"), [(3e-15, 2e-11), (2e-13, 4e-4), (3e-5, 60.0), (0.2, 4e6), (2e-12, 3e5)])
def test_labels_of_both_axes_say_where_they_stand(least, most):
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


@pytest.mark.parametrize("many", [1, 13, 14, 15, 16, 30])
def test_the_legend_of_many_methods_stays_within_the_picture(many):
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


def test_the_page_tells_all_in_words_and_runs_nothing():
    content = gk.tradeoff.chart_files(CHART)["chart.html"].decode()
    page = Outline()
    page.feed(content)
    kinds = [tag for tag, _ in page.tags]
    assert "script" not in kinds and kinds.count("h1") == 1 and "terms" not in kinds and "processor" not in kinds
    style = re.search("<style>(.*)</style>", content, re.DOTALL)[1]
    policy = next(a["content"] for tag, a in page.tags if tag == "meta" and "http-equiv" in a)
    assert b64encode(hashlib.sha256(style.encode()).digest()).decode() in policy and "default-src 'none'" in policy
    assert not any("style" in a or any(key.startswith("on") for key in a) for _, a in page.tags)
    words = re.sub(r"\s+", " ", " ".join(page.words))
    assert "all <terms> : it errs least. It is on the front." in words and "quick run" in words
    assert "a <processor>" in words and words.count("10 calls") == len(POINTS) and "misses 100.0%" in words


def table_of(content):
    """Cells of the first table of a page, row by row, and the class of each row."""
    table = re.search("<table>.*?</table>", content, re.DOTALL)[0]
    found = [re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", row) for row in table.split("<tr")[1:]]
    return found, re.findall(r'<tr(?: class=(\w+))?>(?=<th scope="row")', table)


def test_the_table_of_the_page_tells_every_number():
    some = [point("some", 1.0, 0.5, seconds) for seconds in (2.5, 1.0, 2.5e-2, 1e-3, 2.5e-5, 1e-6, 2.5e-8)]
    family = replace(FAMILY, weighed="bytes", weigh=lambda problem, found: 1.0)
    heavy = [replace(p, weight=w) for p, w in zip((*POINTS, *some), (7.0, *[2.5] * 4, *[np.nan] * 9))]
    chart = replace(CHART, families=(gk.tradeoff.FamilyChart(family, tuple(heavy)),))
    (head, *told), classes = table_of(gk.tradeoff.chart_files(chart)["chart.html"].decode())
    assert head[2:6] == ["largest error, mm", "rms error, mm", "time per sum", "on the front"] and head[8:] == ["bytes"]
    assert [name == "default" for name in classes] == [p.method.startswith("all") for p in heavy]
    times = []
    for row, p, on in zip(told, heavy, chart.families[0].on_front, strict=True):
        assert row[0] == (
            f"{p.method} (default)".replace("<", "&lt;").replace(">", "&gt;") if p is heavy[0] else p.method
        )
        assert row[1] == (f"terms {p.setting:g}" if p.method == "some" else "")
        error, _, missed = row[2].partition(", misses ")
        errors = [float(one.replace("\N{MINUS SIGN}", "-").replace("none", "nan")) for one in (error, row[3])]
        assert errors == pytest.approx([p.largest, p.rms], rel=0.05, nan_ok=True)
        assert (float(missed.rstrip("%")) / 100 if missed else 0.0) == p.missed
        number, unit = row[4].split()
        assert 1 <= float(number) < 1000 and float(number) * SECONDS[unit] == pytest.approx(p.seconds, rel=5e-3)
        times.append(row[4])
        assert row[5] == ("yes" if on else "no") and row[6:8] == ["3 times 10 calls of 1", "5%"]
        assert row[8:] == ([f"{p.weight:g}"] if np.isfinite(p.weight) else [])
    assert times[-7:] == ["2.5 s", "1 s", "25 ms", "1 ms", "25 µs", "1 µs", "25 ns"]


def test_a_default_off_the_front_is_told_with_what_beats_it():
    from tests.tradeoff.toy import METHODS

    slow = gk.tradeoff.Method("slow", "Adds twice.", METHODS[0].make, because="it is checked.", despite="It is safe.")
    family = gk.tradeoff.MethodFamily(**{**vars(FAMILY), "methods": (METHODS[1], slow)})
    points = (point("some", 1.0, 1e-3, 1e-6), point("some", 2.0, 1e-5, 2e-6), point("slow", np.nan, 1e-5, 8e-6))
    chart = gk.tradeoff.Chart((gk.tradeoff.FamilyChart(family, points),), False, {}, "")
    page = gk.tradeoff.chart_files(chart)["chart.html"].decode()
    assert "It is not on the front: some takes 25% of its time. It is safe." in page


def test_what_differs_beyond_six_digits_beats_all_the_same():
    """The front goes by six digits, and so does what a default off it is beaten by."""
    one = replace(FAMILY, methods=(FAMILY.methods[1], replace(FAMILY.methods[0], despite="It is safe.")))
    for beats, default in (
        (point("some", 1.0, 1e-5 * (1 + 1e-9), 2e-6), point("all <terms>", np.nan, 1e-5, 4e-6)),
        (point("some", 1.0, 1e-5, 4e-6 * (1 + 1e-9)), point("all <terms>", np.nan, 2e-5, 4e-6)),
    ):
        family = gk.tradeoff.FamilyChart(one, (beats, default))
        assert family.on_front.tolist() == [True, False]
        page = gk.tradeoff.chart_files(gk.tradeoff.Chart((family,), False, {}, ""))["chart.html"].decode()
        share = "50%" if beats.seconds < 3e-6 else "100%"
        assert f"It is not on the front: some takes {share} of its time. It is safe." in page


def test_what_is_measured_is_what_the_method_does(monkeypatch):
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
def test_batches_go_round_until_each_has_had_its_time(quick, monkeypatch):
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


@pytest.mark.parametrize("told", ["model name\t: Fast <9> : one\nmodel name\t: Other\n", "flags : fpu\n", None])
def test_the_processor_is_told_by_its_name_and_cores(told, monkeypatch, tmp_path):
    file = tmp_path / "cpuinfo"
    if told is not None:
        file.write_text(told)
    monkeypatch.setattr(results, "Path", lambda name: file if name == "/proc/cpuinfo" else None)
    monkeypatch.setattr(results.platform, "processor", lambda: "")
    monkeypatch.setattr(results.platform, "machine", lambda: "abacus")
    monkeypatch.setattr(results.os, "cpu_count", lambda: 6)
    assert results.processor() == ("Fast <9> : one" if told and "model" in told else "abacus") + ", 6 cores"
    monkeypatch.setattr(results.platform, "processor", lambda: "slide rule")
    assert results.processor() == ("Fast <9> : one" if told and "model" in told else "slide rule") + ", 6 cores"


def test_a_family_that_is_not_there_is_refused_with_those_that_are(tmp_path):
    result = CliRunner().invoke(cli, ["chart", "four-bars", "--out", str(tmp_path / "made")])
    assert result.exit_code == 2 and all(name in result.stderr for name in FAMILIES) and not list(tmp_path.iterdir())
    with pytest.raises(gk.DesignError, match="four-bar-position"):
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


def test_every_default_in_the_kept_chart_is_on_the_front_or_says_why_not():
    told = rows((KEPT / "chart.csv").read_bytes())
    assert {row["family"] for row in told} == set(FAMILIES), "make it anew: geomkin chart --out ."
    for name, family in FAMILIES.items():
        points = [row for row in told if row["family"] == name]
        methods = {method.name: method for method in family.methods}
        assert {row["method"] for row in points} == set(methods)
        defaults = [row for row in points if row["default"] == "1"]
        assert defaults and {row["method"] for row in defaults} == {n for n, m in methods.items() if m.is_default}
        for row in defaults:
            assert row["on_front"] == "1" or methods[row["method"]].despite, row
        # What the file says of the front is what its numbers say.
        errors = [max(float(row["largest_error"] or "nan"), family.floor) for row in points]
        errors = [np.nan if float(row["missed_share"]) else error for row, error in zip(points, errors)]
        front = gk.tradeoff.pareto_front([float(row["seconds_per_result"]) for row in points], errors)
        assert [row["on_front"] == "1" for row in points] == front.tolist()


def test_the_kept_chart_s_page_and_pictures_are_those_of_its_table():
    pictures = {path.stem for path in KEPT.glob("*.svg")}
    assert set(FAMILIES) <= pictures and all(any(one.startswith(name) for name in FAMILIES) for one in pictures)
    page = (KEPT / "chart.html").read_text("utf-8")
    for name, family in FAMILIES.items():
        # The page holds each picture as it is.
        _, picture, after = page.partition((KEPT / f"{name}.svg").read_text("utf-8").partition("<text")[2].strip())
        assert picture
        for method in family.methods:
            assert not method.is_default or method.because in page.replace("&#x27;", "'")
            told = html.unescape(after).partition(f"<dt>{method.name}</dt><dd>{method.about}")[2]
            assert told.startswith(" It takes long, and a quick chart leaves it out.</dd>" if method.slow else "</dd>")
    chapter = (KEPT.parents[2] / "docs" / "speed-and-accuracy.md").read_text("utf-8")
    assert [name for name in FAMILIES if f"`{name}`" not in chapter] == []


def test_what_is_made_one_at_a_time_is_timed_one_by_one():
    single = {"file", "profile", "curve", "space", "side of a tooth"}
    found = {family.per: family.count(None, None) for family in FAMILIES.values() if family.per in single}
    assert found == dict.fromkeys(single, 1)
