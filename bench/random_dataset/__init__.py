"""Datasets of poses, Suns and exposures drawn by a seed, rendered by every core, resumed."""
