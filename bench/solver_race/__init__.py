"""Pose solvers side by side, ours and others', on the geometry of the first paper."""
