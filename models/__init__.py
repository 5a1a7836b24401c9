"""Spacecraft, cameras, lights, motion and conventions: no renderer, no truth."""
