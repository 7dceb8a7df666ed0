"""The count of lines of code, on a text whose numbers are known."""

from tests.structure.lines import measured

TEXT = '''"""A module,
of two lines."""

import ast  # code


class Shape:
    """A class."""

    size: int = 3
    """A field."""

    @property
    def area(self):
        """A property."""
        # A comment.
        text = """text, not a
        docstring"""

        def inner():
            return text

        return inner()

    def other(self): ...


def last():
    return (
        1 +

        2
    )
'''


def test_counts():
    lines = measured(TEXT)
    assert lines.code == 1 + 2 + 7 + 1 + 5
    assert lines.docstrings == 5
    assert lines.members == {"Shape": 2}
    assert lines.functions == {"Shape.area": 6, "Shape.area.inner": 2, "Shape.other": 1, "last": 5}
