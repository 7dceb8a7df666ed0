"""Joints: what holds bodies together, one kind a file."""
