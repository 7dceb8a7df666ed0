"""Files of a four-bar, written once, and copies of them to damage."""

import pytest

import geomkin as gk
from tests.verification.damage import RECIPE


@pytest.fixture(scope="session")
def good(tmp_path_factory):
    folder = tmp_path_factory.mktemp("good")
    gk.make(gk.load(RECIPE).with_name("bars"), folder)
    return folder / "bars"


@pytest.fixture
def copy(good, tmp_path):
    for file in good.iterdir():
        (tmp_path / file.name).write_bytes(file.read_bytes())
    return tmp_path
