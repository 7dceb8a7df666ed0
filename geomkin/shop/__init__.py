"""Mechanism and stock to parts. The one place that knows both."""
