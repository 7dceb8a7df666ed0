"""Recipes of coupons."""
