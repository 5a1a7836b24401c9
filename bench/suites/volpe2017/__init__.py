"""Volpe et al. 2017: an unknown target's pose, shape, rates and inertia, on points."""
