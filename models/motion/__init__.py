"""Orbits, relative motion and attitude."""
