"""Sunlight followed from the Sun and connected to the lens: what a lens rarely finds."""
