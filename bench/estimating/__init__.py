"""Pipelines driven over frames."""
