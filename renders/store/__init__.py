"""Rendered light, kept and shared."""
