"""Recipes as texts, of the kinds that geomkin has."""

from functools import cache

from geomkin.recipe import load, template
from geomkin.recipe import template as schema
from geomkin.recipe.kinds import recipe_class


def parse(text, file="recipe", folder="."):
    """The recipe in a text; `file` is what messages call it."""
    return load.parse(text, file, folder)


def template_of(name, options=()):
    """A text to start from, of a kind by its name."""
    return template.template(recipe_class(name), options)


@cache
def recipe_of(name):
    """The recipe of a kind's template, whose search, parts and table are worked out once for all tests."""
    return parse(template_of(name))


def schema_of_all():
    """The schema that editors read."""
    return schema.schema()


def choices_of(name):
    """Tables of which a template shows one kind or none, by dotted key."""
    return template.choices(recipe_class(name))
