"""A dataset folder's public half: its files, read and written."""
