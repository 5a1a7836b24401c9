"""Markers found in image pairs."""
