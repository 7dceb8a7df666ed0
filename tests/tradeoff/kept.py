"""The kept chart read back from its tables; `python -m tests.tradeoff.kept` writes its pictures and its page in docs."""

import csv
from functools import cache
from pathlib import Path

import numpy as np

import geomkin as gk
from geomkin.tradeoff.families import FAMILIES
from geomkin.tradeoff.family import Digits
from geomkin.tradeoff.measurement import CELLS, DIGIT_KINDS, HEADS, POWERS, Stability

FOLDER = Path(__file__).parent.parent / "speed" / "chart"
PAGE = Path(__file__).parents[2] / "docs" / "stability.md"


def table(name):
    with (FOLDER / name).open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def chart():
    """Rounded to six digits, as in its table."""
    rows = table("chart.csv")
    families = [gk.tradeoff.FamilyChart(FAMILIES[name], tuple(_point(row) for row in rows if row["family"] == name))
                for name in dict.fromkeys(row["family"] for row in rows)]  # fmt: skip
    versions = {
        name.removesuffix("_version"): reported for name, reported in rows[0].items() if name.endswith("_version")
    }
    return gk.tradeoff.Chart(tuple(families), False, versions, rows[0]["processor"])


def _point(row):
    numbers = {"setting": "setting", "largest": "largest_error", "rms": "rms_error", "missed": "missed_share",
               "seconds": "seconds_per_result", "spread": "spread", "weight": "weight"}  # fmt: skip
    counts = {"results": "results_per_call", "calls": "calls_per_batch", "batches": "batches"}
    return gk.tradeoff.Measurement(
        row["family"],
        row["method"],
        **{ours: float(row[name] or "nan") for ours, name in numbers.items()},
        **{ours: int(row[name]) for ours, name in counts.items()},
    )


@cache
def study():
    """Rounded to a tenth of a digit, as in its table."""
    cells = {(cell.family, cell.place, cell.result, cell.distance): cell for cell in CELLS}
    found = []
    for row in table("stability.csv"):
        cell = cells[row["family"], row["place"], row["result"], row["distance"]]
        digits = []
        for power in POWERS:
            reported = [row[f"{kind}_1e-{power:02}"] for kind in DIGIT_KINDS]
            numbers = [np.nan if one == "refused" else float(one) for one in reported]
            digits.append(Digits(cell, 10.0**-power, *numbers, refused=reported[0] == "refused"))
        found.append(tuple(digits))
    return Stability(tuple(found))


def pictures():
    """Pictures as they are written of the tables today: name to content."""
    return {name: content for name, content in gk.tradeoff.chart_files(chart()).items() if name.endswith(".svg")}


def tables():
    """The study as tables in Markdown, one for each kind of mechanism."""
    families = {}
    for name, *row in study().table:
        families[name] = families.get(name, "") + f"| {' | '.join(row)} |\n"
    head = f"| {' | '.join(HEADS[1:])} |\n{'|---' * (len(HEADS) - 1)}|\n"
    return "".join(f"\n## {name[0].upper()}{name[1:]}\n\n{head}{lines}" for name, lines in families.items())


if __name__ == "__main__":
    for name, content in pictures().items():
        (FOLDER / name).write_bytes(content)
    PAGE.write_text(PAGE.read_text("utf-8").split("\n## ")[0].rstrip("\n") + "\n" + tables(), "utf-8")
