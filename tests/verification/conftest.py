"""Files of a four-bar and of a gear, written once, and copies of them to damage."""

import shutil

import pytest

import geomkin as gk
from geomkin.verification import certificate, made_again
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


@pytest.fixture
def measuring(monkeypatch):
    """Files are measured even if they are the same as those made again."""
    real = made_again.difference

    def difference(found, expected, kind, measured=False):
        return (
            real(found, expected, kind, measured)
            if measured or kind not in certificate.READERS
            else made_again.Difference(("x",))
        )

    monkeypatch.setattr(certificate, "difference", difference)
