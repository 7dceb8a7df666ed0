"""Optimisation of any recipe: values of its keys that make one result best and keep others within limits."""
