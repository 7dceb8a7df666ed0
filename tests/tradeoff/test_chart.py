"""The chart's files read back: its table, its pictures, its page; and the command that makes them."""

import csv
import hashlib
import io
import re
import xml.etree.ElementTree as ElementTree
from base64 import b64encode
from dataclasses import replace
from html.parser import HTMLParser
from types import SimpleNamespace

import numpy as np
import pytest
from click.testing import CliRunner

import geomkin as gk
from geomkin.cli import cli
from geomkin.core.processes import progress_to
from geomkin.export.summary import write_whole
from geomkin.tradeoff import measurement
from geomkin.tradeoff.families import FAMILIES
from tests.tradeoff import kept
from tests.tradeoff.toy import CHART, FAMILY, POINTS

SVG = "{http://www.w3.org/2000/svg}"
# What a tick's label says, in the axis's unit.
SECONDS = {"ps": 1e-12, "ns": 1e-9, "µs": 1e-6, "ms": 1e-3, "s": 1.0, "ks": 1e3, "": 1.0}
POWERS = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")
FRONT = [True, True, True, False, True, False, False]


def rows(content):
    return list(csv.DictReader(io.StringIO(content.decode())))


def test_the_table_has_every_point():
    reported = rows(gk.tradeoff.chart_files(CHART)["chart.csv"])
    assert [row["method"] for row in reported] == [p.method for p in POINTS]
    assert [row["on_front"] for row in reported] == [str(int(on)) for on in FRONT]
    assert [row["default"] for row in reported] == ["1", "0", "0", "0", "0", "0", "0"]
    for row, p in zip(reported, POINTS):
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


def test_quick_measurement(monkeypatch):
    monkeypatch.setattr("geomkin.tradeoff.measurement.FAMILIES", {"toy-sum": FAMILY})
    monkeypatch.setattr("geomkin.tradeoff.measurement.QUICK", 0.02)
    reported = []
    with progress_to(lambda share, what: reported.append((share, what))):
        (one,) = gk.tradeoff.chart(["toy-sum"], quick=True).families
    assert reported[-1] == (1.0, "measuring toy-sum") and sorted(reported) == reported
    # In a hurry the first, the middle and the last setting, and nothing slow.
    assert [(p.method, p.setting) for p in one.points[1:]] == [("some", 1.0), ("some", 5.0), ("some", 10.0)]
    assert [p.rms for p in one.points] == pytest.approx([p.largest / 2**0.5 for p in one.points])
    assert [p.largest for p in one.points] == pytest.approx([0.0, 0.5, 0.5**5, 0.5**10], abs=1e-15)
    assert all(p.seconds > 0 and p.batches >= 3 and p.calls >= 1 and p.results == 1 for p in one.points)


def test_the_command_writes_the_files_after_each_family(tmp_path, monkeypatch):
    families = {"toy-sum": FAMILY, "other": replace(FAMILY, name="other")}
    monkeypatch.setattr("geomkin.tradeoff.measurement.FAMILIES", families)
    monkeypatch.setattr("geomkin.tradeoff.measurement.QUICK", 0.02)
    written = []

    def note(folder, contents):
        written.append(set(contents))
        write_whole(folder, contents)

    monkeypatch.setattr("geomkin.export.summary.write_whole", note)
    result = CliRunner().invoke(cli, ["chart", "toy-sum", "other", "--quick", "--out", str(tmp_path / "made")])
    assert result.exit_code == 0 and result.stdout.endswith("made/chart: 2 families, 8 points\n")
    names = {"chart.csv", "chart.html", "toy-sum.svg"}
    assert written == [names, names | {"other.svg"}]
    assert {path.name for path in (tmp_path / "made" / "chart").iterdir()} == names | {"other.svg"}


@pytest.mark.parametrize("missing", [True, False])
def test_chart_of_everything_has_the_study_or_states_how_to_get_it(tmp_path, monkeypatch, missing):
    monkeypatch.setattr("geomkin.tradeoff.measurement.FAMILIES", {"toy-sum": FAMILY})
    monkeypatch.setattr("geomkin.tradeoff.files.FAMILIES", {"toy-sum": FAMILY})
    monkeypatch.setattr("geomkin.tradeoff.measurement.QUICK", 0.02)
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None if missing else name)
    monkeypatch.setattr("geomkin.tradeoff.measurement.stability", kept.study)
    result = CliRunner().invoke(cli, ["chart", "--quick", "--out", str(tmp_path)])
    page = (tmp_path / "chart" / "chart.html").read_text("utf-8")
    assert result.exit_code == 0 and 'id="stability"' in page
    assert ("pip install mpmath" in page) == ("pip install mpmath" in result.stderr) == missing
    assert (tmp_path / "chart" / "stability.csv").exists() == ("parallel cranks" in page) == (not missing)
    # A chart of some families does not mention the study.
    assert "mpmath" not in gk.tradeoff.chart_files(replace(CHART, families=()))["chart.html"].decode()


@pytest.mark.campaign
def test_the_quick_chart_of_everything(tmp_path):
    assert CliRunner().invoke(cli, ["chart", "--quick", "--out", str(tmp_path)]).exit_code == 0
    reported = rows((tmp_path / "chart" / "chart.csv").read_bytes())
    assert {row["family"] for row in reported} == set(FAMILIES)


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
    (one,) = measurement.measured_points(family, False, lambda share: None)
    # 0.31, 0.2, 0.5, 0.25, 0.8: as many as take 1.5 s together.
    assert one.batches == 5 and one.calls == 1 and len(calls) == 6
    assert one.seconds == pytest.approx(0.02) and one.spread == pytest.approx(0.55)


def test_weights_have_a_front_a_picture_and_columns_of_their_own():
    (one,) = CHART.families
    family = replace(one.family, weighed="vertices", weigh=lambda problem, found: 1.0)
    weights = (10.0, 1.0, 2.0, 3.0, 4.0, np.nan)
    heavy = gk.tradeoff.FamilyChart(family, tuple(replace(p, weight=w) for p, w in zip(one.points, weights)))
    # The fourth takes longer than one of less error, but weighs less.
    assert heavy.on_front.tolist() == [True, True, True, False, True, False]
    assert heavy.on_weight_front.tolist() == [True, True, True, True, True, False]
    made = gk.tradeoff.chart_files(replace(CHART, families=(heavy,)))
    assert b"vertices per sum" in made["toy-sum-by-vertices.svg"] and b"time per sum" in made["toy-sum.svg"]
    assert [row["weight"] for row in rows(made["chart.csv"])] == ["10", "1", "2", "3", "4", ""]
    assert not [name for name in gk.tradeoff.chart_files(CHART) if "-by-" in name]


@pytest.mark.parametrize("seed", range(2))
def test_front_is_the_set_of_undominated_points(seed):
    """Of whole numbers, so that points are equal in one or in both; some are unknown."""
    numbers = np.random.default_rng(seed)
    seconds, errors = numbers.integers(0, 8, (2, 30)).astype(float)
    errors[numbers.random(30) < 0.1] = np.nan
    seconds[numbers.random(30) < 0.1] = np.inf
    points = [(s, e) for s, e in zip(seconds.tolist(), errors.tolist()) if np.isfinite(s) and np.isfinite(e)]

    def on_front(s, e):
        beaten = any(t <= s and f <= e and (t, f) != (s, e) for t, f in points)
        return bool(np.isfinite(s) and np.isfinite(e)) and not beaten

    front = gk.tradeoff.pareto_front(seconds, errors)
    assert front.tolist() == [on_front(*point) for point in zip(seconds.tolist(), errors.tolist())] and front.any()
