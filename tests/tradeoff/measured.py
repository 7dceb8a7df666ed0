"""Problems and results of families, each made once."""

from functools import cache

import numpy as np

from geomkin.tradeoff.families import FAMILIES


@cache
def problem(name):
    return FAMILIES[name].problem()


def method(name, title):
    (one,) = [m for m in FAMILIES[name].methods if m.name == title]
    return one


def found(name, title, setting=np.nan):
    return method(name, title).make(problem(name), setting)()


def errors(name, results):
    return FAMILIES[name].error(problem(name), results)
