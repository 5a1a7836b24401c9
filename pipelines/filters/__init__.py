"""Filters of the relative state: translation and rotation, each on its own."""
