"""Files of a four-bar and of a gear, written once, and copies of them to damage."""

import shutil

import pytest

import geomkin as gk
from tests.verification.damage import GEAR, RECIPE


@pytest.fixture(scope="session")
def good(tmp_path_factory):
    folder = tmp_path_factory.mktemp("good")
    gk.make(gk.load(RECIPE).with_name("bars"), folder)
    return folder / "bars"


@pytest.fixture(scope="session")
def good_disk(tmp_path_factory):
    folder = tmp_path_factory.mktemp("good")
    gk.make(gk.load(GEAR).with_name("disk"), folder)
    return folder / "disk"


@pytest.fixture
def copy(good, tmp_path):
    return shutil.copytree(good, tmp_path / "bars")


@pytest.fixture
def disk(good_disk, tmp_path):
    return shutil.copytree(good_disk, tmp_path / "disk")
