"""Two cameras on one chaser, chained by its arm: one state of both."""
