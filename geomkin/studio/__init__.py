"""Anything as the page that shows it moving."""
