"""Absolute navigation held against a flight."""
