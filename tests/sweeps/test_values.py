"""Values of a sweep as people write them, and the places in a recipe that they are put in."""

import copy

import numpy as np
import pytest

import geomkin as gk
from geomkin.recipe.keys import with_values
from geomkin.sweeps.evaluation import MOST, combinations, parsed_values


def test_rows_of_values_are_as_a_recipe_has_them():
    row = (np.float64(1.5), np.int64(2), 3 + 4j, (1, np.float32(2)), [np.complex128(1j)], "x", np.True_)
    found = parsed_values("key", row)
    assert found == (1.5, 2, [3.0, 4.0], [1, 2.0], [[0.0, 1.0]], "x", True)
    assert [type(value) for value in found] == [float, int, list, list, list, str, bool]
    assert parsed_values("key", np.array([2, 1, 2])) == (2, 1) and parsed_values("key", range(3)) == (0, 1, 2)
    # A number and its text are two values, as are true and 1; 1 and 1.0 are one.
    assert parsed_values("key", [1, "1", True, 1.0, False, 0, [1], [1], [1.5]]) == (1, "1", True, False, 0, [1], [1.5])
    assert parsed_values("key", [2**63, -(2**63)]) == (2**63, -(2**63))


def test_invalid_values_are_refused():
    for given, field, id, number in [
        (3, "values", "wrong-type", "3"),
        ([None], "a.b", "wrong-type", ""),
        ([float("inf")], "a.b", "wrong-type", "inf"),
        ([{"x": 1}], "a.b", "wrong-type", "{'x': 1}"),
        ([2**63 + 1], "a.b", "out-of-range", str(2**63 + 1)),
        (["x"] * (MOST + 1), "a.b", "too-much-work", "10,001"),
        ("1,,2", "a.b", "wrong-type", "1,,2"),
        (" 3:1:1", "a.b", "wrong-type", "'3:1:1'"),
        (f"0:{MOST}:1", "a.b", "too-much-work", "1.01"),
        ("50:80", "a.b", "wrong-type", "start:stop:step"),
        ("1, 50 - 80", "a.b", "wrong-type", "start:stop:step"),
        ([], "a.b", "missing-key", ""),
    ]:
        with pytest.raises(gk.DesignError) as refusal:
            parsed_values("a.b", given)
        assert (refusal.value.field, refusal.value.id) == (field, id) and number in str(refusal.value)


@pytest.mark.parametrize("counts", [(2, 7000, 3), (10, 10, 10, 11)])
def test_of_too_many_combinations_as_many_as_it_says_can_be_had(counts):
    values = {f"k{k}": tuple(range(count)) for k, count in enumerate(counts)}
    with pytest.raises(gk.DesignError) as refusal:
        combinations(values)
    # "give at most 3,333 values of k1"
    *_, most, _, _, name = refusal.value.remedy.split()
    fewer = values | {name: values[name][: int(most.replace(",", ""))]}
    assert len(list(combinations(fewer))) <= MOST and len(values[name]) == max(counts)
    one_more = values | {name: values[name][: len(fewer[name]) + 1]}
    with pytest.raises(gk.DesignError):
        combinations(one_more)


def test_values_are_put_where_keys_lead_and_nowhere_else():
    recipe = {"a": {"b": [{"c": 1}, {"c": [[1, 2], [3, 4]]}], "1": 5}, "d": 3, "none": []}
    before, point = copy.deepcopy(recipe), [7, 8]
    changed = with_values(recipe, {"a.b[1].c[0][1]": 9, "a.b[0]": "x", "a.1": 6, "e.2f.g": 1, "d": point})
    assert changed == {
        "a": {"b": ["x", {"c": [[1, 9], [3, 4]]}], "1": 6}, "d": [7, 8], "none": [], "e": {"2f": {"g": 1}},
    }  # fmt: skip
    assert recipe == before
    point.append(9)
    assert changed["d"] == [7, 8]
    for key in ("a.b[2].c", "none[0]", "a.b[0][0]", "new[0].x", "a[0]", "d.x", "a.b.c", "none.c.d"):
        with pytest.raises(gk.DesignError) as refusal:
            with_values(recipe, {key: 1})
        assert refusal.value.field == key
    assert recipe == before
