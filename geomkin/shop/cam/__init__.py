"""Plates of a cam and its follower."""
