"""A page, opened in the user's own browser."""
