"""The command's front door: what goes wrong ends in one line and a number, and what someone at a terminal sees."""

import errno
import gc
import os
import signal
import sys

import click
import pytest

from geomkin import __main__ as door
from geomkin import cli as commands


@pytest.fixture
def left(monkeypatch, capsys):
    """left(by): how the program ends, and what it says, where the command ends by an exception or a number."""
    handler, often = signal.getsignal(signal.SIGINT), gc.get_threshold()
    for name in ("OPENBLAS_NUM_THREADS", "PYDANTIC_DISABLE_PLUGINS"):
        monkeypatch.setenv(name, os.environ.get(name, "kept"))

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
