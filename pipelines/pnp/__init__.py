"""Pose from points: the solvers."""
