"""Names that people choose: what is plain and what is refused, for bodies and for files."""

import pytest

import geomkin as gk
from geomkin.core.names import check_names
from geomkin.export.summary import write_whole
from geomkin.model.part import Part

PLAIN = [
    "A",
    "coupler point",
    "drag_link-2",
    "Kurbel",
    "Schwinge ä",
    "e\u0301bauche",
    "曲柄",
    "कड़ी",
    "9",
    "x" * 40,
    "common",
    "nanometre",
]
STRANGE = [
    "",
    " ",
    ".",
    "..",
    "../../evil",
    "/abs/x",
    "a/b",
    "a\\b",
    "a.b",
    "-rf",
    "_hidden",
    " a",
    "a ",
    "a\n",
    "a\tb",
    "a\0b",
    "\x1b[31mred",
    "a\u202eb",
    "a\u200bb",
    "a\u00a0b",
    "\u3164",
    "\u0301a",
    "a \u0301",
    "CON",
    "com1:x",
    "Com1",
    "LPT¹",
    "nul",
    "nan",
    "Infinity",
    "=HYPERLINK(1)",
    "@a",
    "+1",
    "a,b",
    'a"b',
    "<b>",
    "x" * 41,
    "\ud800",
    None,
    3,
    b"a",
]


@pytest.mark.parametrize("names", [STRANGE[k::4] for k in range(4)], ids=ascii)
def test_strange_names_are_refused_everywhere_they_could_enter(names):
    for name in names:
        assert_refused(name)


def assert_refused(name):
    refusals = [
        lambda: check_names("bodies", [name], "a body"),
        lambda: gk.Linkage({"ground": {"O": 0}, name: {"O": 0, "A": 9}}, driver=name),
        lambda: gk.Linkage({"ground": {"O": 0}, "crank": {"O": 0, name: 9}}, driver="crank"),
        lambda: gk.Linkage({"ground": {"O": 0}, "crank": {"O": 0}}, "crank", (gk.Slider(name, "crank", "ground"),)),
        lambda: Part(name, gk.plane.Circle(0, 1), (), 1.0),
    ]
    for refusal in refusals:
        with pytest.raises(gk.DesignError) as refused:
            refusal()
        assert str(refused.value).isprintable()


@pytest.mark.parametrize("twins", [("Arm", "arm"), ("é", "e\u0301"), ("ＡB", "ab"), ("straße", "STRASSE")])
def test_names_that_some_file_system_takes_for_one_are_refused(twins):
    with pytest.raises(gk.DesignError, match="bodies"):
        check_names("bodies", twins, "a body")
    with pytest.raises(gk.DesignError, match="bodies"):
        gk.Linkage({"ground": {"O": 0}, twins[0]: {"O": 0, "A": 3}, twins[1]: {"A": 0}}, driver=twins[0])
    with pytest.raises(gk.DesignError, match="bodies"):
        gk.Linkage({"ground": {"O": 0}, "crank": {"O": 0, twins[0]: 3, twins[1]: 4}}, driver="crank")


def test_the_writer_refuses_two_names_that_differ_only_by_case(tmp_path):
    with pytest.raises(gk.FileError):
        write_whole(tmp_path, {"Gear.stl": b"1", "gear.STL": b"2"})
    assert list(tmp_path.iterdir()) == []
