"""What each annotation lets through, what it turns away, and in which words."""

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from typing import Annotated, Any, Literal

import numpy as np
import pytest
from numpy.typing import ArrayLike, NDArray

import geomkin as gk
from geomkin.core import arguments as of
from geomkin.core.arguments import argument_type, check_fields, checked
from geomkin.core.fields import ComplexOrArray
from geomkin.model.check import AnyNumber


class Plain:
    pass


NAN, INF = np.nan, np.inf
MAY_BE_MISSING = of.argument_type(of.ComplexOrNan).fits
POINT, TRUE = np.array([1j, 2.0]), np.array([True, False])
# Annotation, its words, what it takes, what it refuses.
TYPES = [
    (
        float, "a finite number",
        [1, -1.5, 0, 9e59, -9e59, np.float64(2), np.float32(2), np.int8(3), np.array(2.5)],
        [True, np.bool_(True), NAN, INF, -INF, 2e60, -2e60, "1", None, [1.0], np.array([1.0]), np.array(True), 1j, Fraction(1, 2)],
    ),
    (int, "a whole number", [3, -5, 0, np.int64(3), np.uint8(2)], [3.0, np.float64(3), True, "3", 10**61, -(10**61), None, np.array(3)]),
    (
        complex, "a finite complex number, x + yj",
        [1j, 1, 2.5, -9e59 + 9e59j, np.complex64(1j), np.array(1j), np.array(2)],
        [complex(NAN, 0), complex(0, NAN), complex(2e60, 0), complex(0, 2e60), complex(-2e60, 0), complex(0, -2e60), True, "1",
         [1j], np.array([1j]), None, NAN],
    ),
    (bool, "True or False", [True, np.bool_(False)], [0, 1, None, "yes"]),
    (str, "a text", ["", "a"], [b"a", None, 3]),
    (
        np.ndarray, "a number or an array of numbers",
        [1, 1j, NAN, np.int8(1), POINT, np.zeros((2, 0))], [[1.0], (1.0,), TRUE, "1", None, np.array(["a"]), b"1"],
    ),
    (NDArray[np.floating[Any]], "a real number or an array of them", [1, NAN, np.arange(3), 2.5], [1j, POINT, TRUE, [1.0]]),
    (NDArray[np.integer[Any]], "a whole number or an array of them", [1, np.arange(3), np.uint8(3)], [1.0, np.ones(2), POINT, TRUE, [1]]),
    (NDArray[np.bool_], "True or False, or an array of them", [True, TRUE, np.bool_(False)], [1, np.arange(2), [True], None]),
    (NDArray[np.complexfloating[Any, Any]], "a number or an array of numbers", [1j, 2, POINT], [TRUE, [1j], "1"]),
    (NDArray[Any], "a number or an array of numbers", [1j, 2, POINT], [TRUE, [1j], "1"]),
    (float | None, "a finite number", [1, None], ["", NAN]),
    (int | str | None, "a whole number or a text", [1, "", None], [1.5, b""]),
    (Literal["a", "b", "c"], "a, b or c", ["a", "c"], ["d", "", None, ["a"], "a, b"]),
    (Literal[1, -1], "1 or -1", [1, -1], [0, True, "1", 1.0, None]),
    (tuple[float, int], "a list of 2, each item a finite number", [(1, 2), [1, 2], np.ones(2)], [(1,), (1, 2, 3), 1, (1, "2"), ("1", 2), None, "ab", np.array(2.0)]),
    (tuple[float, ...], "a list, each item a finite number", [(), (1, 2, 3), [4.0], np.ones(4)], [3.0, ("a",), (1, NAN), {1: 2}, "12", None]),
    (Sequence[str], "a list, each item a text", [(), ["a"]], ["ab", [1], None]),
    (list[bool], "a list, each item True or False", [[], [True]], [[1], True]),
    (Mapping[str, float], "a table, each a finite number", [{}, {"a": 1}], [{"a": "b"}, {1: 1}, {"a": 1, "b": None}, [], None]),
    (Callable[[float], float], "a function", [abs, lambda x: x, Plain], [3, None, "abs"]),
    (Callable, "a function", [abs], [3]),
    (Plain, "a Plain", [Plain()], [Plain, None, 3]),
    (Exception, "an Exception", [ValueError()], [ValueError, None]),
    (Annotated[float, "in words", of.ArgumentType(lambda value: value == 3, "three")], "three", [3], [4]),
    (Annotated[float, "in words"], "a finite number", [3], ["3"]),
    (of.PositiveInt, "a whole number above 0", [1, np.int8(3)], [0, -1, 1.0, True, None]),
    (of.PositiveFloat, "a number above 0", [0.5, 1e-300], [0, -1, NAN, INF, True, "1", np.ones(1)]),
    (AnyNumber, "a number", [0.5, NAN, INF, -3, np.float32(1)], [True, 1j, "1", None, np.ones(1)]),
    (
        float | ArrayLike, "finite real numbers, one or an array",
        [1, 2.5, [1, 2], [[1.0], [2.0]], np.ones((2, 2)), (), np.float32(1)],
        [NAN, INF, -INF, 2e60, -2e60, [1, NAN], 1j, [1j], "1", ["1"], None, TRUE, [[1], [1, 2]], np.array([[1, INF]])],
    ),
    (of.FloatOrNan, "real numbers, one or an array", [1, NAN, [1, NAN]], [INF, [1, -INF], 2e60, 1j, "1", None]),
    (of.AnyFloat, "real numbers, one or an array", [1, NAN, INF, [1, -INF]], [1j, "1", None, TRUE]),
    (of.AnyComplex, "numbers, one or an array", [1, NAN, INF, 1j, [1, -INF]], ["1", None, TRUE]),
    (
        complex | ArrayLike, "finite points as complex numbers x + yj, one or an array",
        [1j, 1, [1, 2], np.array([1.0, 2.0]), (1, 2, 3), (1j, 2), [[1j, 2], [3, 4]], [[1, 2, 3]], POINT, ()],
        # Pairs x, y are no points.
        [(1, 2), ((1, 2), (3, 4)), [[1, 2], [3, 4]], np.ones((3, 2)), [1, NAN], complex(0, INF), [1j, complex(NAN, 1)], 2e60j, "1", None],
    ),
    (of.ComplexOrNan, "points x + yj, one or an array", [1j, NAN, [1j, NAN], complex(NAN, NAN)], [INF, 2e60j, [1j, INF], "1", None]),
    (
        ComplexOrArray, "a finite complex number, x + yj, in mm, x and y within 1e+09 of 0",
        [1j, 1, 2.5, POINT, np.array(1j)], [[1j], (1j,), NAN, complex(0, INF), complex(NAN, 0), np.array([NAN]), np.ones((3, 2)), "1", None, True],
    ),
    (of.FloatRow, "a row of finite numbers", [[1, 2], np.ones(3), ()], [1, np.ones((2, 2)), [1, NAN], [1j], "1"]),
    (of.ComplexRow, "a row of finite points x + yj", [[1j, 2], POINT, [1, 2, 3]], [1j, np.array([[1j]]), [1j, NAN], (1, 2)]),
]  # fmt: skip


@pytest.mark.parametrize(("hint", "words", "good", "bad"), TYPES, ids=[words for _, words, *_ in TYPES])
def test_an_annotation_takes_and_refuses_values(hint, words, good, bad):
    expected = argument_type(hint)
    assert expected.allowed
    assert [expected.fits(value) for value in good] == [True] * len(good)
    assert [expected.fits(value) for value in bad] == [False] * len(bad)

    def call(value, other=0):
        return value, other

    call.__annotations__ = {"value": hint, "other": int, "return": Plain}
    held = checked(call)
    for value in good:
        assert held(value)[0] is value and held(value=value, other=2)[1] == 2
    for value in bad:
        for refused in (
            lambda: held(value),
            lambda: held(value=value),
            lambda: held(3, other=value) if hint is int else held(value, 3),
        ):
            with pytest.raises(gk.DesignError) as caught:
                refused()
            name, _, place = caught.value.field.partition("[")
            wanted = expected.each if place else expected
            assert name in ("value", "other") and wanted.allowed in caught.value.remedy


def test_one_wrong_number_is_seen_in_any_shape():
    for wrong, shape, unit in [(NAN, (3,), 1.0), (INF, (2, 3), 1j), (2e60, (3, 8192), 1.0), (-2e60, (30_000,), 1j)]:
        for at in (0, -1):
            row = np.ones(shape) * unit
            assert of.are_points(row) and of.are_reals(row) is (unit == 1)
            row.reshape(-1)[at] = complex(0, wrong) if unit == 1j else wrong
            assert not of.are_points(row) and not of.are_reals(row)
            assert MAY_BE_MISSING(row) is bool(np.isnan(wrong))


@pytest.mark.parametrize("kind", [np.float32, np.complex64])
def test_single_precision_has_the_same_limits_and_no_warning(kind):
    largest = np.full((2, 3), 3e38, kind)
    assert of.are_points(largest) and of.is_place(largest) and MAY_BE_MISSING(largest) and of.is_complex(largest[0, 0])
    assert of.are_reals(largest) is of.is_real(largest[0, 0]) is (kind == np.float32)
    for wrong in (NAN, INF):
        largest[1, 2] = wrong
        assert not of.are_points(largest) and not of.is_complex(largest[1, 2]) and not of.is_real(largest[1, 2])
    bar = gk.FourBar(*np.array([100, 30, 90, 70], np.float32))
    angles = gk.move(bar, np.linspace(0, 6, 9, dtype=np.float32)), gk.move(bar, np.linspace(0, 6, 9))
    assert np.ptp([gk.least_transmission_angle(motion) for motion in angles]) < 1e-5


@dataclasses.dataclass
class Held:
    number: float
    words: str = None
    size: float = dataclasses.field(default=1.0, metadata={"unit": "mm"})
    count: int = 3
    any: Any = None

    def __post_init__(self):
        check_fields(self)


def test_fields_are_held_to_their_annotations_but_for_sizes():
    # A size has limits of its own, and None stands for what the class fills in.
    assert Held(1, None, "far", 2, object()).count == 2
    for values, name, _words in (
        ({"number": None}, "number", "give a finite number"),
        ({"number": 1, "words": 3}, "words", "give a text"),
        ({"number": 1, "count": None}, "count", "give a whole number"),
        ({"number": "x" * 200, "count": None}, "number", "give a finite number"),
    ):
        with pytest.raises(gk.DesignError) as caught:
            Held(**values)
        assert caught.value.field == name and len(caught.value.problem) < 100


def test_optional_points_are_refused_after_another_package_has_named_the_same_union():
    _ = ArrayLike | None

    @checked
    def call(points: None | complex | ArrayLike = None) -> None: ...

    call(), call(1j), call([1j, 2.0])
    with pytest.raises(gk.DesignError):
        call("text")
