"""Targets and chasers as named, dimensioned parts."""
