"""Frames as pictures, with marks."""
