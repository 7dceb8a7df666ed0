"""A recipe over all combinations of values."""
