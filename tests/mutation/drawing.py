"""A plugin of pytest that notes which test runs which line of geomkin, and how long each test takes.

Every worker of pytest-xdist keeps a file of its own in the folder `.mutation`. What a test file runs while it is
imported is noted under the file's name.
"""

import json
from pathlib import Path

import coverage
import pytest

FOLDER = Path(__file__).parent.parent.parent / ".mutation"
recorder = coverage.Coverage(FOLDER / "map", data_suffix=True, source=["geomkin"], config_file=False, messages=False)
seconds = {}


def pytest_configure(config):
    if hasattr(config, "workerinput"):
        recorder.start()


def pytest_collectstart(collector):
    _note_under(collector)


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_protocol(item):
    _note_under(item)


def pytest_runtest_logreport(report):
    seconds[report.nodeid] = seconds.get(report.nodeid, 0) + report.duration


def pytest_unconfigure(config):
    if hasattr(config, "workerinput"):
        recorder.stop()
        recorder.save()
    else:
        (FOLDER / "seconds.json").write_text(json.dumps(seconds))


def _note_under(node):
    if hasattr(node.config, "workerinput"):
        recorder.switch_context(node.nodeid)
