"""Recipes of cams."""
