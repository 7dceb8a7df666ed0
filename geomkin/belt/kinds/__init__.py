"""Recipes of belt and chain drives."""
