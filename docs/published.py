"""Worked examples in print: each computed again from `published.toml`, for the site and for the tests."""

import tomllib
from dataclasses import dataclass
from decimal import Decimal
from functools import cache
from pathlib import Path

import numpy as np

import geomkin as gk

GROUPS = ("Linkages", "Synthesis", "Forces", "Cams", "Gears", "Steps and reducers")


@dataclass(frozen=True)
class Value:
    """A number of an example: what is printed, what should be if that is wrong, and what is found."""

    quantity: str
    at: str
    unit: str
    printed: str
    right: str
    found: float
    within: float
    note: str

    @property
    def agrees(self) -> bool:
        """Whether the number found rounds to the printed one, or, of a misprint, to the right one and not to that."""
        close = [abs(self.found - float(text)) <= self.within for text in (self.printed, self.right or self.printed)]
        return close == [not self.right, True]


def half_digit(printed: str) -> float:
    """Half a unit of the last digit, and a little for rounding."""
    return 0.5001 * 10.0 ** int(Decimal(printed).as_tuple().exponent)


@cache
def examples() -> dict[str, dict]:
    """The examples by id, in the order of the table."""
    table = tomllib.loads(Path(__file__).with_name("published.toml").read_text("utf-8"))
    return {example["id"]: example for example in table["example"]}


@cache
def values(id: str) -> list[Value]:
    """The numbers of an example, computed as its page states."""
    example = examples()[id]
    names: dict = {"gk": gk, "np": np}
    if "recipe" in example:
        names["recipe"] = gk.load(example["recipe"])
        names |= {"table": names["recipe"].table, "design": names["recipe"].design}
    exec(compile(example["code"], id, "exec"), names)
    rows = []
    for value in example["value"]:
        found = np.atleast_1d(eval(compile(value["code"], id, "eval"), names))
        at = value.get("at", example.get("at", [""]))
        right = value.get("right", [""] * len(at))
        for place, printed, correct, number in zip(at, value["printed"], right, found, strict=True):
            within = value.get("within", half_digit(printed))
            texts = (value["quantity"], place, value.get("unit", ""), printed, correct)
            rows.append(Value(*texts, float(number), within, value.get("note", "")))
    return rows


def published_pages() -> dict[str, str]:
    """A page of each example, and one that lists them."""
    pages = {f"published/{id}.md": page(id) for id in examples()}
    rows = ["# Examples in print, computed again", INTRODUCTION]
    for group in GROUPS:
        rows += [f"\n## {group}\n", "| example | source | numbers | misprints |", "|---|---|---|---|"]
        for id, example in examples().items():
            if example["group"] == group:
                found = values(id)
                wrong = sum(bool(value.right) for value in found)
                rows.append(f"| [{example['title']}]({id}.md) | {example['source']} | {len(found)} | {wrong or ''} |")
    tree = "\n".join(examples())
    rows.append(f"\n```{{toctree}}\n:hidden:\n{tree}\n```\n")
    return pages | {"published/index.md": "\n".join(rows)}


INTRODUCTION = """
Each page has the statement of an example, a recipe that runs as it stands, and the printed numbers next to those of geomkin,
which were computed when this site was built. A number agrees if it rounds to the printed digits; where more is allowed, the
page gives the reason. Misprints are marked, with what should be printed."""


def page(id: str) -> str:
    """Statement, recipe, code, and the numbers side by side."""
    example = examples()[id]
    text = f"# {example['title']}\n\n*{example['source']}*\n\n{example['statement']}\n"
    if "recipe" in example:
        text += f"\n## Recipe\n\n```toml\n{example['recipe'].strip()}\n```\n"
    text += "\n## Numbers side by side\n\n| quantity | at | unit | printed | geomkin | result |\n|---|---|---|---|---|---|\n"
    above = ""
    for value in values(id):
        digits = max(0, -int(Decimal(value.printed).as_tuple().exponent))
        result = f"**misprint**, right: {value.right}" if value.right else value.note or "agrees"
        quantity, above = (value.quantity if value.quantity != above else "", value.quantity)
        row = (quantity, value.at, value.unit, value.printed, f"{value.found:.{digits + 2}f}", result)
        text += f"| {' | '.join(row)} |\n"
    if "note" in example:
        text += f"\n{example['note']}\n"
    lines = [example["code"].strip()] + [f"{value['code']}  # {value['quantity']}" for value in example["value"]]
    code = "\n".join(line for line in lines if line)
    given = "`recipe` is the recipe above, `table` and `design` are its own" if "recipe" in example else "no recipe"
    return text + f"\n## How it is computed\n\nIn Python, after `import geomkin as gk` and `import numpy as np`; {given}:\n\n```python\n{code}\n```\n"
