"""A scenario's things, composed."""
