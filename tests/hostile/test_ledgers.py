"""A sweep's ledger spoilt by anyone: the sweep is that of no ledger, and says so in plain lines."""

import json

import pytest

RECIPE = """kind = "spur-gear"
[gear]
teeth = 20
module = 2
[stock]
bore = 5
"""
SWEEP = ("sweep", "r.toml", "--set", "gear.teeth=18,2", "--tell", "measures_mm.tip_radius")


def changed(place, value):
    """A spoiler of the first row: what stands at a place of it becomes a value."""

    def spoil(lines):
        entry = json.loads(lines[1])
        held = entry["row"]
        for key in place[:-1]:
            held = held[key]
        held[place[-1]] = value
        return [lines[0], json.dumps(entry), *lines[2:]]

    return spoil


def with_row(row):
    return lambda lines: [lines[0], json.dumps({"key": json.loads(lines[1])["key"], "row": row}), *lines[2:]]


SPOILT = {
    "no row": with_row({}),
    "row of texts": with_row({"refused": "", "checks": "none", "told": {}}),
    "refused by a terminal": changed(["refused"], "\x1b]0;owned\x07\x1b[31m"),
    "refused by half a character": changed(["refused"], "\ud800"),
    "check of an endless number": changed(["checks"], [["a", 10**400, "at least", 1.0, ""]]),
    "check named by a terminal": changed(["checks"], [["\x1b[2J", 0.0, "at least", 1.0, "\x07"]]),
    "telling an endless number": changed(["told", "measures_mm.tip_radius"], 10**400),
    "deep": lambda lines: [lines[0], "[" * 100_000, *lines[1:]],
    "title gone": lambda lines: lines[1:],
}


@pytest.mark.parametrize("name", SPOILT)
def test_a_spoilt_ledger_is_begun_anew(geomkin, here, name):
    (here / "r.toml").write_text(RECIPE)
    first = geomkin(*SWEEP)
    files = {path.name: path.read_bytes() for path in (here / "out/r").iterdir()}
    ledger = here / "out/r/r.sweep.jsonl"
    ledger.write_text("\n".join(SPOILT[name](ledger.read_text().split("\n"))))
    done = geomkin(*SWEEP)
    assert done.exit_code == first.exit_code == 0 and "anew" in done.stderr and done.stderr.count("\n") == 1
    assert done.stdout == first.stdout and all(line.isprintable() for line in done.stderr.splitlines())
    now = {path.name: path.read_bytes() for path in (here / "out/r").iterdir()}
    # Rows may be found in another order.
    lines = [sorted(held.pop("r.sweep.jsonl").splitlines()) for held in (files, now)]
    assert now == files and lines[0] == lines[1]


@pytest.mark.parametrize("share", [0.2, 0.8])
def test_a_ledger_cut_off_gives_the_same_sweep(geomkin, here, share):
    (here / "r.toml").write_text(RECIPE)
    geomkin(*SWEEP)
    table, ledger = here / "out/r/r.sweep.csv", here / "out/r/r.sweep.jsonl"
    whole, rows = ledger.read_bytes(), table.read_bytes()
    ledger.write_bytes(whole[: int(share * len(whole))])
    assert geomkin(*SWEEP).exit_code == 0 and table.read_bytes() == rows
    assert sorted(ledger.read_bytes().splitlines()) == sorted(whole.splitlines())
