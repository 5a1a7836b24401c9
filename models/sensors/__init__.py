"""What measures: parameters and noise, as data."""
