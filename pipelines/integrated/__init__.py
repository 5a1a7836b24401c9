"""Absolute navigation that feeds relative navigation: one unit, two filters, one estimate."""
