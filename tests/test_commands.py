"""What the commands print and write of recipes that pass, fail a check, or cannot be made; each recipe once."""

import pytest
from click.testing import CliRunner

from geomkin import cli as commands
from geomkin.build import check_recipe

GEAR = 'kind = "spur-gear"\n[gear]\nteeth = {}\nmodule = 2\n'


@pytest.fixture
def command(tmp_path, monkeypatch):
    """command(*words): exit status, stdout and stderr of a run in a folder with three gears.

    `a` passes, `b` fails a check, `c` cannot be made.
    """
    monkeypatch.chdir(tmp_path)
    (tmp_path / "in").mkdir()
    for name, teeth in {"a": 24, "b": 9, "c": 1}.items():
        (tmp_path / f"in/{name}.toml").write_text(GEAR.format(teeth))

    def call(*words):
        result = CliRunner().invoke(commands.cli, words)
        return result.exit_code, result.stdout, result.stderr

    return call


def test_check_prints_every_check_with_its_verdict_and_writes_nothing(command, tmp_path):
    code, output, wrong = command("check", "in/a.toml", "in/b.toml")
    expected = []
    for name in "ab":
        made = check_recipe(tmp_path / f"in/{name}.toml")
        expected += [name, *(f"  {'pass' if check.passed else 'FAIL'}  {check}" for check in made.checks)]
        expected += [f"        {fact}" for fact in made.facts]
    assert (code, wrong, output.splitlines()) == (0, "", expected)
    assert "  FAIL  " in output and "  pass  " in output and [path.name for path in tmp_path.iterdir()] == ["in"]
    code, output, wrong = command("check", "in")
    assert code == 1 and output.splitlines() == expected and wrong.startswith("in/c.toml: gear.teeth: found 1; give ")


def test_a_recipe_that_is_named_twice_is_made_once_and_a_folder_has_a_page_over_all(command, tmp_path):
    code, output, wrong = command("run", "in/b.toml", "in", "in/a.toml", "--out", "made", "--only", "csv")
    # In the order in which they are named, those of a folder by name.
    assert [line.partition(":")[0] for line in output.splitlines()] == ["made/b", "made/a"]
    assert code == 1 and wrong.splitlines()[0].startswith("in/c.toml: gear.teeth")
    (tmp_path / "in/c.toml").unlink()
    for name in "ab":
        with (tmp_path / f"in/{name}.toml").open("a") as file:
            file.write('[files]\nwrite = ["csv"]\n')
    for words, index in ((["in/a.toml"], False), (["in/a.toml", "in/b.toml"], True)):
        folder = f"made{len(words)}{index}"
        assert command("run", *words, "--out", folder)[0] == 0
        assert (tmp_path / folder / "index.html").exists() == index, words
    (tmp_path / "in/b.toml").unlink()
    assert command("run", "in", "--out", "alone")[0] == 0 and (tmp_path / "alone/index.html").exists()


@pytest.mark.parametrize(
    "words",
    [["run", "empty"], ["run", "in/a.toml", "--only", "csv,stp"], ["run"], ["new", "spur-gaer"]],
)
def test_invalid_options_are_refused_and_nothing_is_made(command, tmp_path, words):
    (tmp_path / "empty").mkdir()
    (tmp_path / "other").mkdir()
    (tmp_path / "other/a.toml").write_text(GEAR.format(24))
    code, printed, wrong = command(*words)
    assert code == 2 and printed == "" and wrong
    assert not (tmp_path / "out").exists()


def test_a_certificate_holds_until_the_recipe_is_run_again(command, tmp_path):
    words = ("run", "in/a.toml", "in/b.toml", "--only", "svg")
    certificate = tmp_path / "out/a/verify.json"
    code, printed, _ = command(*words, "--verify")
    assert code == 0 and "out/b: 1 files measured, as designed" in printed and certificate.exists()
    first = certificate.read_bytes()
    assert command("verify", "out")[0] == 0 and certificate.read_bytes() == first
    drawing = tmp_path / "out/a/a.svg"
    drawing.write_text(drawing.read_text().replace('class="CUT"', 'class="HOLE"'))
    code, printed, _ = command("verify", "out")
    assert (
        code == 1 and "out/a: 1 files measured, NOT as designed" in printed and "out/b: 1 files measured, as" in printed
    )
    assert certificate.read_bytes() != first
    assert command(*words)[0] == 0 and not certificate.exists()
