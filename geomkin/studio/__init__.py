"""Animated pages of mechanisms in a notebook."""
