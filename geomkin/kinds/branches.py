"""How a recipe says the branch: `branch` for all dyads, and a table `branches` for single joints."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from ..linkage.solve.branch import Chosen
from ..sizes import SignOrPlace, entry

Branches = dict[str, Annotated[Any, SignOrPlace()]]


def branches_entry() -> Any:
    """The table of branches of single joints."""
    return entry(
        "branch of single joints: 1 or -1; or of a point roughly where it is at first, [x, y] in mm: the branch "
        "nearest to that",
        default_factory=dict,
    )


def branch_of(branch: Literal[1, -1, "follow"], branches: Mapping[str, int | complex]) -> Chosen:
    """The branch that a recipe's `branch` and `branches` ask for."""
    signs = {name: value for name, value in branches.items() if not isinstance(value, complex)}
    near = {name: value for name, value in branches.items() if isinstance(value, complex)}
    return Chosen(1 if branch == "follow" else branch, signs, near, branch == "follow", "branches")
