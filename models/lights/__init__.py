"""The Sun and the lamps."""
