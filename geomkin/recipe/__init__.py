"""Recipes: text to frozen data, one class for each kind of mechanism."""
