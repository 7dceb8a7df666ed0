"""Linkages whose output follows a function of their input."""
