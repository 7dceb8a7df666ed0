"""Recipe of cycloidal drives."""
