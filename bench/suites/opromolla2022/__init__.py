"""Opromolla et al. 2022: both cameras, every sequence of its tables, and what it left out."""
