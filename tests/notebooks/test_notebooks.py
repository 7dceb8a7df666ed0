"""The notebooks that teach: each cell runs, shows what it is there to show, and the figures are those of another road."""

import ast
import contextlib
import io
import json
from pathlib import Path

import numpy as np
import pytest

NOTEBOOKS = Path(__file__).parent.parent.parent / "recipes" / "notebooks"
NAMES = ["disk-cam", "four-bar", "spur-gears"]
FORMATS = {"text/html": "_repr_html_", "image/svg+xml": "_repr_svg_"}


def cells(name):
    return json.loads((NOTEBOOKS / f"{name}.ipynb").read_text("utf-8"))["cells"]


class Run:
    """All cells run one after the other: their names, what they print, and what each shows last, by format."""

    def __init__(self, name):
        self.names, self.shown, printed = {}, [], io.StringIO()
        for cell in cells(name):
            if cell["cell_type"] != "code":
                continue
            body = ast.parse("".join(cell["source"])).body
            last = body.pop() if isinstance(body[-1], ast.Expr) else None
            with contextlib.redirect_stdout(printed):
                exec(compile(ast.Module(body, []), name, "exec"), self.names)
                value = eval(compile(ast.Expression(last.value), name, "eval"), self.names) if last else None
            summary = {kind: getattr(value, method)() for kind, method in FORMATS.items() if hasattr(value, method)}
            self.shown.append({kind: text for kind, text in summary.items() if text})
        self.printed = printed.getvalue()

    def count(self, kind):
        return sum(kind in shown for shown in self.shown)

    def __getattr__(self, name):
        return self.names[name]


@pytest.fixture
def run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return Run


@pytest.mark.parametrize("name", NAMES)
def test_notebook_is_kept_without_outputs(name):
    assert sorted(file.stem for file in NOTEBOOKS.glob("*")) == NAMES
    summary = json.loads((NOTEBOOKS / f"{name}.ipynb").read_text("utf-8"))
    assert (summary["nbformat"], summary["nbformat_minor"]) == (4, 5) and summary["metadata"]["kernelspec"][
        "name"
    ] == "python3"
    assert len({cell["id"] for cell in summary["cells"]}) == len(summary["cells"])
    assert summary["cells"][0]["source"][0].startswith("# ")
    code = [cell for cell in summary["cells"] if cell["cell_type"] == "code"]
    assert not any(cell["outputs"] or cell["execution_count"] for cell in code)


def test_the_linkage(run):
    ran = run("four-bar")
    assert ran.count("text/html") == 4 and all("<iframe" in s["text/html"] for s in ran.shown if s)
    # The rocker's ends by the law of cosines: crank and coupler in one line, stretched and folded.
    ground, crank, coupler, rocker = 100, 30, 90, 70

    def angle_at_rocker(far):
        return np.degrees(np.arccos((ground**2 + rocker**2 - far**2) / (2 * ground * rocker)))

    swing = angle_at_rocker(coupler + crank) - angle_at_rocker(coupler - crank)
    assert ran.swing == pytest.approx(swing, abs=2e-3) and f"{ran.swing:.2f}°" in ran.printed
    ends = [
        np.degrees(np.arccos((ground**2 + far**2 - rocker**2) / (2 * ground * far)))
        for far in (coupler + crank, coupler - crank)
    ]
    assert (ran.first, ran.second) == pytest.approx((ends[0], ends[1] + 180))
    assert ran.time_ratio == pytest.approx((180 + ends[1] - ends[0]) / (180 - ends[1] + ends[0]))
    # Where crank and ground are in line the coupler and the rocker span least.
    least = np.degrees(np.arccos((coupler**2 + rocker**2 - (ground - crank) ** 2) / (2 * coupler * rocker)))
    assert ran.least == pytest.approx(least) and "a crank-rocker" in ran.printed
    assert ran.wiper.ratio <= 5 * (1 + 1e-9) and "crank: 20.00 mm" in ran.printed
    assert {file.name for file in Path().iterdir()} == {"four-bar.dxf", "four-bar.csv"}


def test_the_cam(run):
    ran = run("disk-cam")
    assert ran.count("text/html") == 2 and ran.count("image/svg+xml") == 1
    # Textbook figures of 20 mm in a quarter turn: coefficients pi^2 / 2, 2 pi and 10 / sqrt 3.
    turn = np.pi / 2
    for law, coefficient in (("harmonic", np.pi**2 / 2), ("cycloidal", 2 * np.pi), ("3-4-5", 10 / np.sqrt(3))):
        assert ran.laws[law][0] == pytest.approx(coefficient * 20 / turn**2, rel=1e-5)
    assert ran.laws["harmonic"][1] == pytest.approx(40) and ran.laws["cycloidal"][1] < 1
    # Pressure angle by the slope of the lift over the distance of the roller's centre, by differences.
    lift = ran.program.motion(ran.angle).lift
    slope = np.gradient(lift, ran.angle)
    assert ran.most == pytest.approx(np.degrees(np.arctan(slope / (50 + lift)).max()), abs=1e-3)
    assert "30.00° at most" in ran.printed and ran.lost > 0
    assert {file.name for file in Path().iterdir()} == {"disk-cam.dxf", "disk-cam.csv"}


def test_the_gears(run):
    ran = run("spur-gears")
    assert ran.count("text/html") == 3 and ran.count("image/svg+xml") == 3
    assert ran.fewest == pytest.approx(17.097, abs=1e-3) and not ran.better.is_undercut
    # Shift without undercut: the teeth that are lacking, over the fewest; the rack of ISO 53 reaches one module deep.
    assert ran.shift == pytest.approx((ran.fewest - 8) / ran.fewest, abs=1e-4)
    # Length of contact by hand, over the base pitch.
    one, two = ran.better, ran.gear
    bases = one.base_radius + two.base_radius
    way = sum(np.sqrt(g.tip_radius**2 - g.base_radius**2) for g in (one, two)) - np.sqrt(
        ran.pair.centre_distance**2 - bases**2
    )
    assert ran.pair.contact_ratio == pytest.approx(way / one.base_pitch)
    involute = np.tan(np.radians(20)) - np.radians(20)
    assert ran.span.length == pytest.approx(2 * np.cos(np.radians(20)) * (2.5 * np.pi + 24 * involute))
    assert {file.name for file in Path().iterdir()} == {"gear-pair.dxf", "gear-pair.svg"}


@pytest.mark.campaign
@pytest.mark.filterwarnings("default")
@pytest.mark.parametrize("name", NAMES)
def test_a_kernel_runs_it(name, tmp_path):
    """As a reader's own: in a process of its own, with the displays that it makes of what cells end in."""
    nbformat, nbclient = (pytest.importorskip(n, reason="no notebook extra") for n in ("nbformat", "nbclient"))
    pytest.importorskip("ipykernel")
    book = nbformat.read(NOTEBOOKS / f"{name}.ipynb", as_version=4)
    nbformat.validate(book)
    nbclient.NotebookClient(
        book, timeout=60, kernel_name="python3", resources={"metadata": {"path": str(tmp_path)}}
    ).execute()
    outputs = [output for cell in book.cells if cell.cell_type == "code" for output in cell.outputs]
    assert not any(output.output_type == "error" for output in outputs)
    kinds = [kind for output in outputs if output.output_type == "execute_result" for kind in output.data]
    assert kinds.count("text/html") >= 2 and kinds.count("text/plain") > kinds.count("text/html")
