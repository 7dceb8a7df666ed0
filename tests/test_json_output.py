"""What the commands print for programs: one JSON object per recipe, and the columns of a table."""

import json

import pytest
from click.testing import CliRunner

import geomkin as gk
from geomkin.build import check_recipe
from geomkin.cli import cli

GEAR = 'kind = "spur-gear"\n[gear]\nteeth = {}\nmodule = 2\n[files]\nwrite = ["csv"]\n'


@pytest.fixture
def command(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name, teeth in (("a", 20), ("b", 8), ("c", 2)):
        (tmp_path / f"{name}.toml").write_text(GEAR.format(teeth))

    def run(*words):
        result = CliRunner().invoke(cli, words)
        return result.exit_code, [json.loads(line) for line in result.stdout.splitlines()], result.stderr

    return run


@pytest.mark.parametrize("name", ["run", "check"])
def test_a_recipe_is_one_object(command, name, tmp_path):
    code, objects, wrong = command(name, "--json", "a.toml", "b.toml", "c.toml")
    made, failing, refused = objects
    assert code == 1 and wrong == ""
    assert [one["file"] for one in objects] == ["a.toml", "b.toml", "c.toml"]
    assert (made["name"], made["kind"]) == ("a", "spur-gear") and "problems" not in made
    recipe = gk.load(tmp_path / "b.toml")
    for entry, check in zip(failing["checks"], recipe.checks, strict=True):
        assert (entry["id"], entry["name"], entry["side"], entry["unit"], entry["passed"]) == (
            check.id,
            check.name,
            check.side,
            check.unit,
            check.passed,
        )
        assert entry["value"] == pytest.approx(check.value) and entry["limit"] == pytest.approx(check.limit)
    assert made["facts"] == list(check_recipe(tmp_path / "a.toml").facts) != []
    assert sorted(made["files"]) == (["out/a/a.csv", "out/a/summary.json"] if name == "run" else [])
    assert "checks" not in refused
    assert [(one["id"], one["key"]) for one in refused["problems"]] == [("out-of-range", "gear.teeth")]
    assert all(one["problem"] and one["remedy"] for one in refused["problems"])


def test_a_missing_file_is_an_object_too(command):
    for name in ("run", "check"):
        code, (made, missing), wrong = command(name, "--json", "a.toml", "missing.toml")
        assert (code, wrong, made["name"]) == (1, "", "a")
        assert [problem["id"] for problem in missing["problems"]] == ["file-unreadable"]
    code, (missing,), wrong = command("sweep", "--json", "missing.toml", "--set", "gear.teeth=2")
    assert (code, wrong) == (1, "") and [problem["id"] for problem in missing["problems"]] == ["file-unreadable"]


def test_a_sweep_is_one_object_with_a_row_for_each_combination(command):
    code, (one,), _ = command("sweep", "--json", "a.toml", "--set", "gear.teeth=2,8,20", "--result", "along:last")
    assert code == 0 and (one["name"], one["kind"], one["file"]) == ("a", "spur-gear", "a.toml")
    assert [row["values"] for row in one["rows"]] == [{"gear.teeth": teeth} for teeth in (2, 8, 20)]
    assert [bool(row["refused"]) for row in one["rows"]] == [True, False, False]
    assert "tip_thickness" in [check["id"] for check in one["rows"][1]["checks"]]
    assert one["rows"][2]["results"]["along:last"] > 0 and len(one["files"]) == 2
    code, (one,), wrong = command("sweep", "--json", "a.toml", "--set", "gear.tooth=2")
    assert code == 1 and wrong == "" and [problem["id"] for problem in one["problems"]] == ["unknown-key"]


def test_a_sweep_s_table_has_a_column_for_each_check_by_its_id(tmp_path):
    found = gk.sweep(GEAR.format(20), {"gear.teeth": [8, 20]})
    for teeth, row, failed in zip((8, 20), range(2), found.table["failed"].tolist(), strict=True):
        checks = gk.load(GEAR.format(teeth)).checks
        assert failed.split("; ") == [check.id for check in checks if not check.passed] or not failed
        assert {check.id: found.table[check.id][row] for check in checks} == {
            c.id: pytest.approx(c.value) for c in checks
        }


def test_a_fault_of_geomkin_is_a_problem_too(command, monkeypatch):
    from geomkin import build

    def failing(file):
        raise RuntimeError("odd")

    monkeypatch.setattr(build, "check_recipe", failing)
    code, (one,), _ = command("check", "--json", "a.toml")
    assert code == 1 and [problem["id"] for problem in one["problems"]] == ["internal"]


def test_columns_lists_id_unit_and_meaning(command, tmp_path):
    result = CliRunner().invoke(cli, ["columns", "a.toml"])
    columns = gk.load(tmp_path / "a.toml").table.columns
    assert result.exit_code == 0
    for line, column in zip(result.stdout.splitlines(), columns, strict=True):
        assert line.split()[0] == column.id and line.endswith(f"  {column.meaning}")
        assert column.unit in line.split()[1:2] or not column.unit
    assert CliRunner().invoke(cli, ["columns", "c.toml"]).exit_code == 1
