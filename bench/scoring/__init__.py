"""Estimates held against the truth."""
