"""Estimates made elsewhere: BOP results, SPEED submissions, TUM trajectories, our own format."""
