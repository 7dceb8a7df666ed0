"""A sweep's table and page, from rows made by hand: what is a number, a text, a line, a limit, and how much is shown."""

import math
import re

import numpy as np
import pytest

import geomkin as gk
from geomkin.sweeps import evaluation
from geomkin.sweeps.evaluation import SweepTask, evaluate, file_hashes
from geomkin.sweeps.sweep import SweepRow, sweep_columns, sweep_page, swept
from tests.sweeps.test_sweep import BAR


def test_numbers_stay_numbers_and_all_else_is_text():
    results = [
        {"whole": 1, "some": 1.5, "mixed": 2, "yes": True, "row": [0, 1.5], "huge": 2**63, "a:b": None},
        {"whole": -3, "some": None, "mixed": "x", "yes": False, "row": ["a", True], "huge": 0, "a:b": None},
    ]
    made = sweep_columns(["key"], [SweepRow({"key": k}, "", (), one) for k, one in enumerate(results)])
    found = {column.header: column.values.tolist() for column in made}
    assert found["whole"] == [1, -3] and found["huge"] == [2**63, 0] and found["key"] == [0, 1]
    assert found["some"][0] == 1.5 and math.isnan(found["some"][1]) and np.isnan(found["a_b"]).all()
    assert (
        found["mixed"] == ["2", "x"] and found["yes"] == ["true", "false"] and found["row"] == ["[0, 1.5]", "[a, true]"]
    )
    assert {column.values.dtype.kind for column in made if column.id in ("whole", "key")} == {"i"}


@pytest.fixture
def task(tmp_path):
    """task(*names): of a four-bar, with these results."""
    data = {"kind": "four-bar", "linkage": {"ground": 100, "crank": 30, "coupler": 90, "rocker": 70},
            "drive": {"step_deg": 90}}  # fmt: skip
    return lambda *names: SweepTask(data, "bar\n.toml", str(tmp_path), names)


def test_page_has_headings_in_words_and_noise_as_zero():
    names = ("transmission_angle:least", "swings_deg.rocker.swing", "stroke_mm")
    results = [dict(zip(names, values)) for values in ((6.4e-15, 40.0, 1e-3), (32.5, 6e-9, 2.0))]
    rows = [SweepRow({"crank": k}, "", (), row) for k, row in enumerate(results)]
    page = sweep_page("a", {"crank": [0, 1]}, rows).decode()
    heads = re.findall('<th scope="col">([^<]*)', page)
    assert heads[2:] == ["Least transmission angle", "Swings, rocker, swing, °", "Stroke, mm"]
    cells = [re.findall("<td>([^<]*)", row) for row in re.findall("<tr class=.*?</tr>", page)]
    assert [row[1:] for row in cells] == [["0", "40", "0.001"], ["32.5", "6e\N{MINUS SIGN}09", "2"]]


def test_reported_results_are_those_of_table_and_notes(task):
    names = ["transmission_angle_deg:least", "transmission_angle_deg:largest", "rocker_angle_deg:last", "nothing:least",
             "grashof_type", "stack.pins[1].length_mm", "nothing", "versions.nothing"]  # fmt: skip
    sizes = {"linkage.crank": 80, "linkage.coupler": 60, "linkage.rocker": 50, "drive.end_deg": 180}
    row, open_row = evaluate(task(*names), [{}, sizes])
    recipe = gk.load(BAR.replace("end_deg = 30", "").replace("step_deg = 10", "step_deg = 90"))
    angles = recipe.table["transmission_angle_deg"]
    assert row["results"]["transmission_angle_deg:least"] == pytest.approx(angles.min())
    assert row["results"]["transmission_angle_deg:largest"] == pytest.approx(angles.max()) != angles.min()
    assert row["results"]["rocker_angle_deg:last"] == pytest.approx(recipe.table["rocker_angle_deg"][-1])
    assert row["results"]["nothing:least"] is None and row["results"]["nothing"] is None
    assert row["results"]["grashof_type"] == recipe.notes["grashof_type"]
    assert row["results"]["stack.pins[1].length_mm"] == recipe.notes["stack"]["pins"][1]["length_mm"]
    # Where the last row cannot be, there is no last value, though there is a least one.
    results = open_row["results"]
    assert results["rocker_angle_deg:last"] is None and np.isfinite(results["transmission_angle_deg:least"])


@pytest.mark.parametrize(
    ("fault", "words"),
    [
        (RuntimeError("a\x1bb"), "a?b"),
        (gk.DesignError("crank", "found 1", "give 2"), "crank: found 1; give 2"),
        (gk.RecipeError("bar\n.toml", []), ""),
    ],
    ids=repr,
)
def test_failing_combination_stops_no_other(task, monkeypatch, fault, words):
    real = SweepTask.opened

    def opened(self, changes):
        if changes:
            raise fault
        return real(self, changes)

    monkeypatch.setattr(SweepTask, "opened", opened)
    bad, good = evaluate(task("grashof_type"), [{"linkage.crank": 3}, {}])
    assert words in bad["refused"] and (bad["checks"], bad["results"]) == ([], {})
    assert not good["refused"] and good["checks"] and good["results"]["grashof_type"]


def test_files_that_a_recipe_names_count_where_they_lie_beside_it(tmp_path, monkeypatch):
    home = tmp_path / "home"
    home.mkdir()
    for path, content in ((home / "a.csv", "1"), (home / "same.csv", "1"), (tmp_path / "out.csv", "2")):
        path.write_text(content)
    held = {"one": "a.csv", "rows": [{"two": "same.csv"}, ("a.csv",)], "words": "no file", "number": 3, "empty": ""}
    marks = file_hashes(held, str(home))
    assert len(marks) == 3 and len(set(marks)) == 1
    (home / "a.csv").write_text("3")
    assert [old == new for old, new in zip(marks, file_hashes(held, str(home)))] == [False, True, False]
    (home / "link.csv").symlink_to(tmp_path / "out.csv")
    for name in ("../out.csv", "link.csv", "a\0.csv", "x" * 2000, str(home)):
        assert file_hashes(name, str(home)) == []
    monkeypatch.setattr(evaluation, "LARGEST_FILE", 0)
    assert file_hashes("a.csv", str(home)) == []


def test_a_process_that_was_killed_costs_its_own_combinations_alone(task):
    def run(work, batches):
        return ((k, None if k == 1 else work(batch)) for k, batch in enumerate(batches))

    rows = swept(task().recipe, {"linkage.crank": [20 + k for k in range(10)]}, (), None, run).rows
    refused = [k for k, row in enumerate(rows) if row.refused]
    assert 0 < len(refused) < len(rows) and refused == list(range(refused[0], refused[-1] + 1))
    assert all("killed" in rows[k].refused and not rows[k].checks for k in refused)
