"""Recipes that find a linkage."""
