"""Measures of how wrong a pose is: ours, SPEED's, BOP's, ADD; each as its authors define it."""
