"""Which of a recipe's parts, tables, scenes and derivatives are worked out while each of its files is made."""

from collections import Counter
from functools import cached_property
from itertools import chain

import pytest

from geomkin import build
from geomkin.export import WRITERS, job
from geomkin.export.formats import Writer
from geomkin.linkage.solve.drive_range import DriveRange
from geomkin.recipe.kinds import KINDS, recipe_class

HELD = ("parts", "table", "scene")
# Of a linkage, by its drive.
ORDERS = ("first derivatives", "second derivatives")


class Watch:
    """`log`: by stage, how often each thing was worked out. Stages are the checks, each format, and the summary."""

    def __init__(self):
        self.log, self.stage, self.patch = {}, "checks", pytest.MonkeyPatch()

    def __enter__(self):
        for order in ORDERS:
            method = order.split()[0]
            self.patch.setattr(DriveRange, method, self._seen(getattr(DriveRange, method), order))
        self.patch.setattr(job, "cut", self._seen(job.cut, "loops"))
        for cls in set(chain.from_iterable(recipe_class(kind).__mro__ for kind in KINDS)):
            for name in HELD:
                self._watch_property(cls, name)
        for name, writer in WRITERS.items():
            staged = self._staged(writer.write, name)
            self.patch.setitem(WRITERS, name, Writer(**{**vars(writer), "write": staged}))
        self.patch.setattr(build, "summary", self._staged(build.summary, "summary"))
        return self

    def __exit__(self, *error):
        self.patch.undo()

    def _note(self, what):
        self.log.setdefault(self.stage, Counter())[what] += 1

    def _seen(self, f, what):
        def seen(*args, **named):
            self._note(what)
            return f(*args, **named)

        return seen

    def _staged(self, f, stage):
        def staged(*args, **named):
            self.stage = stage
            return f(*args, **named)

        return staged

    def _watch_property(self, cls, name):
        held = vars(cls).get(name)
        if isinstance(held, cached_property):
            watched = cached_property(self._seen(held.func, name))
            watched.__set_name__(cls, name)
            self.patch.setattr(cls, name, watched)
        elif isinstance(held, property) and not getattr(held, "__isabstractmethod__", False):
            self.patch.setattr(cls, name, property(self._seen(held.fget, name)))
