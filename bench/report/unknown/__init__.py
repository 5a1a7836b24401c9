"""The report of a target that nobody has a model of."""
