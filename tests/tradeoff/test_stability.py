"""What the library does at each place where methods fail, against arithmetic of 120 digits and textbooks' formulas."""

import dataclasses

import numpy as np
import pytest

import geomkin as gk
from geomkin.tradeoff.family import ANSWERS, answered, measured_digits
from geomkin.tradeoff.measurement import CELLS
from tests.tradeoff import kept

every_cell = pytest.mark.parametrize("cell", CELLS, ids=lambda cell: cell.name)


def design_checks(cell, distances):
    found = [measured_digits(cell, x) for x in distances]
    reported = [(one.distance, one.outcome, round(one.library, 1), round(one.allowed, 1)) for one in found]
    assert cell.answer in ANSWERS and answered(found) == cell.answer, reported
    for one in found:
        if cell.amplification is not None:
            assert one.library + np.log10(one.amplification) >= 14, "the amplification shows the loss"
    return found


@every_cell
def test_library_agrees_with_the_stability_table(cell):
    found = design_checks(cell, (1e-1, 1e-7, 1e-15))
    # And the sizes are those of the kept table, to the rounding of its digits.
    (then,) = [[row[0], row[6], row[14]] for row in kept.study().results if row[0].cell is cell]
    assert [one.allowed for one in found] == pytest.approx([one.allowed for one in then], abs=0.06)


def test_the_page_in_docs_is_that_of_the_kept_study():
    """`python -m tests.tradeoff.kept` writes it."""
    page = kept.PAGE.read_text("utf-8")
    assert len(CELLS) == 58 and "58 cases" in page and page.endswith(kept.tables())
    assert all(row[0].cell.answer == answer for row, answer in zip(kept.study().results, kept.study().answers))


# Places that hold for the very sizes alone.
ONLY_THERE = ("change point, followed", "pressure angle to its limits")


@pytest.mark.parametrize("cell", [c for c in CELLS if c.place not in ONLY_THERE], ids=lambda cell: cell.name)
def test_beside_the_place_formula_and_library_are_one_for_any_sizes(cell):
    """Far from where they break, and with no size as round as it is there: whatever one of them leaves out shows."""
    given = cell.sizes(1e-1)
    change = 1 - 3e-3 * np.random.default_rng(len(cell.name)).random(len(given))
    # Numbers of teeth stay whole.
    whole = [("gear" in cell.family and size == round(size)) for size in given]
    sizes = tuple(size if keep else size * by for size, keep, by in zip(given, whole, change.tolist()))
    one = measured_digits(dataclasses.replace(cell, sizes=lambda _: sizes), 1e-1)
    assert one.library > 10, (sizes, one.library)


@every_cell
@pytest.mark.campaign
def test_it_does_so_at_all_distances(cell):
    design_checks(cell, [10.0 ** -(k / 3) for k in range(3, 46)])


def test_the_textbook_s_formula_breaks_where_the_library_s_does_not():
    """Without which the study would look at places that are easy."""
    for place in ("toggle gap", "near-miss of a change point", "offset to the prime radius"):
        for cell in (c for c in CELLS if c.place == place):
            one = measured_digits(cell, 1e-11)
            assert one.library > 14 and one.textbook < 13, cell.name


def test_a_loss_without_a_word_is_found():
    cell = next(c for c in CELLS if c.name == "four-bar, toggle gap: rate")

    def textbook(*sizes):
        from mpmath import fp

        return cell.formula(fp, *sizes)

    def outcome(**other):
        return answered([measured_digits(dataclasses.replace(cell, **other), x) for x in (1e-1, 1e-9)])

    far = {"sizes": lambda x: (*cell.sizes(x)[:4], 1.0)}
    assert outcome() == outcome(**far) == outcome(library=textbook, **far) == "all"
    assert outcome(library=textbook) == "sizes" and outcome(library=lambda *sizes: 0.0) == "lost"
    # A search that comes back with nothing.
    assert outcome(library=lambda *sizes: ()) == "nan"


def test_error_of_small_and_large_modules_is_as_reported():
    far = {"module over 2 mm": lambda module: module / 2, "2 mm over the module": lambda module: 2 / module}
    cells = [cell for cell in CELLS if cell.distance in far and cell.result == "form radius"]
    assert {cell.distance for cell in cells} == set(far)
    for cell in cells:
        for x in (1e-1, 3e-6):
            assert far[cell.distance](cell.sizes(x)[1]) == pytest.approx(x)


def test_error_of_small_and_large_linkages_and_cams_is_as_reported():
    """By the first length beside that of the words; every length is as many times as large, and no angle."""
    reported = {"sizes over 100 mm": 100, "100 mm over sizes": 100, "sizes over 20 mm": 20, "20 mm over sizes": 20}
    cells = [cell for cell in CELLS if cell.distance in reported]
    assert {cell.distance for cell in cells} == set(reported)
    for cell in cells:
        plain, angle = cell.sizes(1.0), 4 if cell.family == "four-bar" else 3
        assert reported[cell.distance] in plain
        for x in (1e-1, 3e-6):
            shares = np.array(cell.sizes(x)) / plain
            assert shares[angle] == 1
            assert np.delete(shares, angle) == pytest.approx(1 / x if "over sizes" in cell.distance else x)


@pytest.mark.parametrize("shift", [-0.2, 0.4])
def test_the_textbook_s_centre_distance_is_the_library_s_where_it_has_one(shift):
    fp = pytest.importorskip("mpmath").fp
    (cell,) = [c for c in CELLS if c.family == "gear pair"]
    for sizes in ((20.0, 31.0, 2.0, shift), (100.0, 100.0, 0.5, shift)):
        assert cell.formula(fp, *sizes) == pytest.approx(cell.library(*sizes), rel=1e-12)


def test_cells_of_gears_are_on_the_reported_side():
    """Undercut that is about to end, tips that are about to be pointed, both the less the nearer."""
    under, tips = (
        next(c for c in CELLS if c.place == place)
        for place in ("cut-in radius to the base circle", "tips nearly pointed")
    )
    lost, thick = [], []
    for x in (1e-1, 1e-2, 1e-3):
        teeth, module, shift = under.sizes(x)
        lost.append(gk.SpurGear(int(teeth), module, shift, on_pointed_tip="cut").lost_to_undercut)
        thick.append(gk.SpurGear(12, 2, tips.sizes(x)[1]).tip_thickness)
    for row in (lost, thick):
        assert row[0] > row[1] > row[2] > 0 and row[2] < 0.02 * row[0]
