"""What all tests share: what a collected test is made of is not looked through for rubbish again and again."""

import gc

import pytest

# Ten thousand tests are some million objects that stay to the end. Looked through whenever Python looks for what can be
# thrown away, they cost a tenth of the run; so nothing is looked for while they are collected, and they are set aside.
gc.disable()


@pytest.hookimpl(trylast=True)
def pytest_collection_finish(session):
    gc.collect()
    gc.freeze()
    gc.enable()
