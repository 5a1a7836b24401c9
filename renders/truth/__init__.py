"""What really was: the sealed half of a dataset."""
