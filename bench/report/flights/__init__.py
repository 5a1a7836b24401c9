"""The report of an absolute navigation."""
