"""Absolute navigation: orbit, attitude, clock and biases from GNSS, gyroscopes and stars."""
