"""Whole cases rendered, resumed, and exposed again."""
