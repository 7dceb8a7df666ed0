"""What all tests share: examples that are the same in every run, a cache of bytecode, and less looking for rubbish."""

import gc
import os
import sys
import zlib

import pytest
from hypothesis import settings

# The same source passes or fails alike on every machine and day; other examples come with whatever changes a test.
settings.register_profile("repeatable", derandomize=True, deadline=None, max_examples=50)
settings.load_profile("repeatable")

# The share of the cases of campaigns that is run, always the same ones.
CAMPAIGN_SHARE = float(os.environ.get("GEOMKIN_CAMPAIGN_SHARE", "1"))

# Without its bytecode each process of a run, one that a test starts too, compiles the package: seconds instead of tenths.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False

# Ten thousand tests are some million objects that stay to the end. Looked through whenever Python looks for what can be
# thrown away, they cost a tenth of the run; so nothing is looked for while they are collected, and they are set aside.
# Reading a source file or a recipe makes as many again for a moment: from then on it looks a hundred times less often.
gc.disable()


@pytest.hookimpl(trylast=True)
def pytest_collection_finish(session):
    gc.collect()
    gc.freeze()
    gc.set_threshold(70_000, 10, 10)
    gc.enable()


def pytest_collection_modifyitems(config, items):
    """Of a smaller campaign each function has its first case and a share of the others."""
    met, left_out = set(), set()
    for item in items:
        if item.get_closest_marker("campaign"):
            function = item.nodeid.partition("[")[0]
            if function in met and zlib.crc32(item.nodeid.encode()) >= CAMPAIGN_SHARE * 2**32:
                left_out.add(item)
            met.add(function)
    if left_out:
        config.hook.pytest_deselected(items=list(left_out))
        items[:] = [item for item in items if item not in left_out]
