"""Forces of a motion."""
