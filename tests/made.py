"""Examples that are built when a test asks for them."""

from collections.abc import Mapping


class Made(Mapping):
    """Examples by name from what builds them, each built once, on demand.

    Built when a test file is imported, a fault in their class would take the whole file out, not fail its tests.
    """

    def __init__(self, makers):
        self._makers, self._built = makers, {}

    def __getitem__(self, name):
        if name not in self._built:
            self._built[name] = self._makers[name]()
        return self._built[name]

    def __iter__(self):
        return iter(self._makers)

    def __len__(self):
        return len(self._makers)
