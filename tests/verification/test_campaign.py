"""Campaign: all of hundreds of damaged files are found."""

import shutil

import numpy as np
import pytest

from tests.verification.damage import damaged, damages, only, wrong

DAMAGES = 300


@pytest.mark.campaign
def test_every_damage_is_found(good, tmp_path):
    missed = []
    for damage in damages(np.random.default_rng(9), DAMAGES):
        folder = shutil.copytree(good, tmp_path / damage.name)
        name = damaged(folder, damage)
        only(folder, name)
        if name not in wrong(folder):
            missed.append(damage)
        shutil.rmtree(folder)
    assert not missed
