"""Cases of a test that only campaigns run."""

import pytest


def by_default(cases, chosen):
    """All cases, those not chosen with the marker `campaign`: chosen by a slice, or by what each case is."""
    cases = list(cases)
    kept = range(len(cases))[chosen] if isinstance(chosen, slice) else [k for k, c in enumerate(cases) if c in chosen]
    assert len(kept) >= (1 if isinstance(chosen, slice) else len(chosen))
    return [case if k in kept else _in_campaigns(case) for k, case in enumerate(cases)]


def _in_campaigns(case):
    values, name = (case.values, case.id) if hasattr(case, "marks") else (case, None)
    return pytest.param(*(values if isinstance(values, tuple) else (values,)), id=name, marks=pytest.mark.campaign)
