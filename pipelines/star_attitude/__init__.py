"""Attitude from star images: spots, whose stars they are, and which way the camera looks."""
