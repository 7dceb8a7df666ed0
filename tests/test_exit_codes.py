"""The command's front door: what goes wrong ends in one line and a number, and what someone at a terminal sees."""

import errno
import gc
import os
import re
import signal
import sys

import click
import pytest
from click.testing import CliRunner

from geomkin import __main__ as door
from geomkin import build
from geomkin import cli as commands
from geomkin.core.processes import report


@pytest.fixture
def left(monkeypatch, capsys):
    """left(by): how the program ends, and what it says, where the command ends by an exception or a number."""
    handler, often = signal.getsignal(signal.SIGINT), gc.get_threshold()
    monkeypatch.setenv("OPENBLAS_NUM_THREADS", os.environ.get("OPENBLAS_NUM_THREADS", "kept"))

    def call(by):
        def cli(standalone_mode):
            assert not standalone_mode and signal.getsignal(signal.SIGINT) is door._stop
            if isinstance(by, BaseException):
                raise by
            return by

        monkeypatch.setattr(commands, "cli", cli)
        with pytest.raises(SystemExit) as end:
            door.main()
        # As the interpreter ends: a text is said, and is a failure.
        code = end.value.code
        said = "" if sys.stderr.closed else capsys.readouterr().err
        return (1, f"{said}{code}\n") if isinstance(code, str) else (code, said)

    yield call
    signal.signal(signal.SIGINT, handler)
    gc.set_threshold(*often)
    gc.unfreeze()


@pytest.mark.parametrize(
    ("by", "code", "said"),
    [
        (0, 0, ""),
        (3, 3, ""),
        (click.ClickException("no\x07 such\nas this"), 1, "no? such\nas this\n"),
        (click.UsageError("wrong"), 2, "wrong\n"),
        (OSError(errno.ENOSPC, "No space left", "a\nb"), 1, "No space left"),
        (ValueError("a\x1bb"), 1, "a?b"),
    ],
    ids=repr,
)
def test_each_end_is_a_number_and_at_most_plain_lines(left, by, code, said):
    found, message = left(by)
    assert found == code and said in message and message.count("\n") == said.count("\n") + (said[-1:] not in ("", "\n"))


GEAR = 'kind = "spur-gear"\n[gear]\nteeth = {}\nmodule = 2\n'


@pytest.fixture
def watched(monkeypatch, tmp_path):
    """watched(*arguments): the command run where someone watches; a gear of 33 teeth reports its progress."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("geomkin.cli.recipes._is_terminal", lambda stream: True)
    monkeypatch.setattr("click._termui_impl.isatty", lambda stream: True)
    monkeypatch.setattr("geomkin.core.processes.worker_count", lambda: 1)
    handler = signal.getsignal(signal.SIGINT)
    real = build.make

    def make(file, **options):
        if "= 33" in file.read_text():
            report(0.375, "looking for teeth")
            report(1.0, "looking for teeth")
        return real(file, **options)

    monkeypatch.setattr(build, "make", make)

    def call(*arguments):
        result = CliRunner().invoke(commands.cli, arguments, color=True)
        return result.exit_code, result.stdout, result.stderr

    yield call
    signal.signal(signal.SIGINT, handler)


def screen(text):
    """What a terminal shows in its last line one after the other: from each start of a line to the next."""
    return [re.sub(r"\x1b\[[\d;?]*[A-Za-z]", "", line).rstrip() for line in re.split("[\r\n]", text)]


def test_one_recipe_reports_its_progress_on_its_own_line(watched, tmp_path):
    (tmp_path / "a.toml").write_text(GEAR.format(33))
    code, _, output = watched("run", "a.toml", "--only", "csv")
    lines = screen(output)
    # The line is empty again in the end, and each is written over the one before it.
    assert code == 0 and lines[:3] == ["", "looking for teeth: 38%", ""] and "Recipes" not in output
    assert output.count("\r\x1b[K") == 2
