"""Curves that points of the coupler draw."""
