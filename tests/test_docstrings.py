"""Docstrings: their examples run, and the public functions describe parameters and results."""

import doctest
import inspect
import re
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

import geomkin as gk
from tests.campaign import by_default

PACKAGE = Path(gk.__file__).parent
WITH_EXAMPLES = [path for path in sorted(PACKAGE.rglob("*.py")) if ">>>" in path.read_text(encoding="utf-8")]
PACKAGES = (gk, gk.linkage, gk.cam, gk.gear, gk.synthesis, gk.plane, gk.making, gk.model, gk.recipe, gk.tradeoff)


def name_of(path):
    return ".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts).removesuffix(".__init__")


@pytest.mark.parametrize(
    "path",
    by_default(WITH_EXAMPLES, [path for path in WITH_EXAMPLES if path.parent.parent.name != "synthesis"]),
    ids=name_of,
)
def test_examples_run(path, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    failed, tried = doctest.testmod(
        import_module(name_of(path)), extraglobs={"gk": gk, "np": np}, optionflags=doctest.ELLIPSIS
    )
    assert tried and not failed


def test_public_functions_describe_parameters_and_results():
    incomplete = set()
    for package in PACKAGES:
        for name in package.__all__:
            thing = getattr(package, name)
            if inspect.isfunction(thing):
                sections = ["Returns", *["Parameters"] * bool(inspect.signature(thing).parameters)]
                if any(f"\n    {section}\n    ---" not in (thing.__doc__ or "") for section in sections):
                    incomplete.add(name)
    assert not incomplete


def test_public_names_lead_to_others():
    """The section See Also of each names what is used with it, and all are public."""
    public = [name for name in gk.__all__ if not hasattr(getattr(gk, name), "__path__")]
    for name in public:
        section = re.search(r"See Also\n-+\n(.+?)(?:\n\n|$)", inspect.getdoc(getattr(gk, name)), re.DOTALL)
        named = re.findall(r"\w+", section[1])
        assert set(named) <= set(public) - {name}, name
