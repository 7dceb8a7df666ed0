"""Values of a sweep as people write them, and the places in a recipe that they are put in."""

import copy

import numpy as np
import pytest

import geomkin as gk
from geomkin.sweeps.row import MOST, combinations, listed, with_values


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("'a,b',\"c,'d\",e", ["a,b", "c,'d", "e"]),
        ("[[1, 2], [3]],[4]", [[[1, 2], [3]], [4]]),
        # Brackets within quotes are none.
        ("'[',1,']'", ["[", 1, "]"]),
        ("a[1,2]b,c", ["a[1,2]b", "c"]),
        ("[1", ["[1"]),
        (" x y , z", ["x y", "z"]),
        ("'1','true'", ["1", "true"]),
        ("1\nb = 2", ["1\nb = 2"]),
        ("0x10,1_000,+3,1e2", [16, 1000, 3, 100.0]),
        (" -5 : 5 : 5 ,7", [-5, 0, 5, 7]),
        (".5:1.5:.5", [0.5, 1.0, 1.5]),
        ("1e0:3.:1", [1, 2, 3]),
        ("5:4:-.5", [5, 4.5, 4]),
    ],
)  # fmt: skip
def test_lists_of_values_as_people_write_them(text, values):
    assert list(listed("key", text)) == values


def test_rows_of_values_are_as_a_recipe_has_them():
    row = (np.float64(1.5), np.int64(2), 3 + 4j, (1, np.float32(2)), [np.complex128(1j)], "x", np.True_)
    found = listed("key", row)
    assert found == (1.5, 2, [3.0, 4.0], [1, 2.0], [[0.0, 1.0]], "x", True)
    assert [type(value) for value in found] == [float, int, list, list, list, str, bool]
    assert listed("key", np.array([2, 1, 2])) == (2, 1) and listed("key", range(3)) == (0, 1, 2)
    # A number and its text are two values, as are true and 1; 1 and 1.0 are one.
    assert listed("key", [1, "1", True, 1.0, False, 0, [1], [1], [1.5]]) == (1, "1", True, False, 0, [1], [1.5])
    assert listed("key", [2**63, -(2**63)]) == (2**63, -(2**63))


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (3, "values: found 3 for a.b; give a row of values, or a text"),
        ({"x": 1}, "for a.b; give a row of values, or a text"),
        ([None], "a.b: found None; give finite numbers, texts, true or false, or points [x, y]"),
        ([float("inf")], "a.b: found inf; give finite"),
        ([[1, [float("nan")]]], "a.b: found nan; give finite"),
        ([{"x": 1}], "a.b: found {'x': 1}; give finite"),
        ([list(range(MOST + 1))], "; give finite"),
        ([2**63 + 1], "a.b: found 9223372036854775809; give a smaller number"),
        (["x"] * (MOST + 1), "a.b: found 10,001 values; give at most 10,000"),
        ("1,,2", "a.b: found '1,,2', in which a value is missing; give one between any two"),
        (" 3:1:1", "a.b: found '3:1:1'; give start:stop:step"),
        (f"0:{MOST}:1", "a.b: found '0:10000:1', which is more than 10,000 values; give a step of at least 1.01"),
        ([], "a.b: found no value; give one or more, such as 8,12 or 8:120:4"),
    ],
    ids=str,
)
def test_values_that_cannot_be_are_told_with_what_can(given, words):
    with pytest.raises(gk.DesignError) as refusal:
        listed("a.b", given)
    assert words in str(refusal.value)


def test_as_many_values_as_there_may_be():
    assert len(listed("key", f"1:{MOST}:1")) == len(listed("key", ["x", *range(MOST - 1)])) == MOST
    assert len(listed("key", [list(range(MOST))])[0]) == MOST


@pytest.mark.parametrize("key", ["a", "a b-c", "größe", "a[0]", "a[0][12].b", "a.b.c[999999]", "2a"])
def test_what_is_a_key(key):
    assert listed(key, [1]) == (1,)


@pytest.mark.parametrize("counts", [(2, 7000, 3), (101, 100), (30, 40, 50), (10, 10, 10, 11)])
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


def test_where_no_key_alone_can_be_shortened_the_whole_is_told():
    values = {f"k{k}": (1, 2) for k in range(15)}
    with pytest.raises(gk.DesignError, match="= 32,768 combinations; give values that make at most 10,000"):
        combinations(values)


def test_the_last_key_runs_fastest():
    assert list(combinations({"a": (1, 2), "b": "xy"})) == [
        {"a": 1, "b": "x"}, {"a": 1, "b": "y"}, {"a": 2, "b": "x"}, {"a": 2, "b": "y"},
    ]  # fmt: skip


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
    for key, words in (
        ("a.b[2].c", "found [2], but there are 2, from [0]; give a smaller number"),
        ("none[0]", "found [0], but there are 0, from [0]"),
        ("a.b[0][0]", "there is no list that [0] could be of; give a key of the recipe"),
        ("new[0].x", "there is no list that [0] could be of"),
        ("a[0]", "there is no list that [0] could be of"),
        ("d.x", "there is no table that [x] could be of"),
        ("a.b.c", "there is no table that [c] could be of"),
        ("none.c.d", "there is no table that [c] could be of"),
    ):
        with pytest.raises(gk.DesignError) as refusal:
            with_values(recipe, {key: 1})
        assert refusal.value.field == key and words in str(refusal.value), key
    assert recipe == before


def test_a_key_that_begins_with_a_digit_is_refused_as_unknown():
    for key in ("2a", "linkage.2a", "linkage.²"):
        with pytest.raises(gk.DesignError, match="unknown key"):
            gk.sweep({"kind": "four-bar", "linkage": {"ground": 9, "crank": 3, "coupler": 8, "rocker": 7}}, {key: [1]})
