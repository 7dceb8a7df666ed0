"""The kept chart beside what is written, counted, weighed and missed today."""

import re

import numpy as np
import pytest

from geomkin.tradeoff.families import FAMILIES
from tests.tradeoff import kept

NUMBER = re.compile(r"(\d+(?:\.\d+)?(?:e[-+]\d+)?)")
CHART = {one.family.name: one for one in kept.chart().families}
# Methods that take longer a call, s, are left to their own tests, and of these families the two finest settings, since
# their errors take long.
LONGEST, LONG = 0.15, {"cam-flattening", "cam-profile"}
# Their methods have bounds on both sides in test_curve_families.
SLOW = {
    "cam-flattening",
    "cam-profile",
    "conjugate-tooth",
    "dxf-writing",
    "function-synthesis",
    "gear-flattening",
    "gear-root",
    "stl-writing",
}
# Errors of more than this are those of the method, whatever the machine, unless it rounds to single precision; others are
# as large as they were but for a factor.
SURE, FACTOR = 1e-6, 8


@pytest.fixture(scope="module")
def written():
    return kept.files()


def differs(new, old):
    """Whether two pieces of a text differ by more than the last digit of a number that was rounded before."""
    if new == old:
        return False
    if not (NUMBER.fullmatch(new) and NUMBER.fullmatch(old)):
        return True
    places = [10.0 ** (int(p or 0) - len(m.partition(".")[2])) for m, _, p in (x.partition("e") for x in (new, old))]
    return min(places) >= 1 or abs(float(new) - float(old)) > 1.01 * max(places)


@pytest.mark.parametrize("name", sorted(path.name for path in kept.FOLDER.iterdir() if path.suffix != ".html"))
def test_tables_and_pictures_are_rewritten_as_kept(name, written):
    """Texts to the letter, numbers to their last digit, since the tables hold no more than six."""
    mine, theirs = written[name].decode(), (kept.FOLDER / name).read_text("utf-8")
    assert mine == theirs or not name.endswith(".csv")
    pieces = NUMBER.split(mine), NUMBER.split(theirs)
    assert [len(row) for row in pieces] == [len(pieces[1])] * 2
    assert [(new, old) for new, old in zip(*pieces) if differs(new, old)] == []


def test_all_files_that_are_written_are_kept(written):
    assert {path.name for path in kept.FOLDER.iterdir()} == set(written) - {"chart.html"}


@pytest.mark.parametrize("name", [pytest.param(n, marks=pytest.mark.campaign) if n in SLOW else n for n in FAMILIES])
def test_methods_find_what_the_kept_chart_says(name):
    """As many results, of the same weight, as far from the right ones, and as many missed."""
    family, points = FAMILIES[name], CHART[name].points
    chosen = [(method, setting) for method in family.methods for setting in method.settings or (np.nan,)]
    assert [(p.method, repr(p.setting)) for p in points] == [(m.name, repr(float(setting))) for m, setting in chosen]
    problem = family.problem()
    for (method, setting), point in zip(chosen, points):
        finest = name in LONG and setting in method.settings[2:][-2:]
        if finest or point.seconds * point.results > LONGEST:
            continue
        found = method.make(problem, setting)()
        errors = np.asarray(family.error(problem, found), dtype=float)
        known = errors[np.isfinite(errors)]
        assert family.count(problem, found) == point.results
        assert 1 - known.size / errors.size == pytest.approx(point.missed, abs=1e-6)
        if family.weigh:
            assert family.weigh(problem, found) == pytest.approx(point.weight, rel=1e-5)
        largest, rms = (known.max(), np.sqrt(np.mean(known**2))) if known.size else (np.nan, np.nan)
        assert np.isnan(largest) == np.isnan(point.largest)
        for now, then in ((largest, point.largest), (rms, point.rms))[: 2 * known.size]:
            share = max(now, family.floor) / max(then, family.floor)
            off = 1e-3 if then > SURE and method.name != "single precision" else FACTOR - 1
            assert 1 / (1 + off) <= share <= 1 + off, (method.name, setting, now, then)
