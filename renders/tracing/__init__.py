"""Light, traced."""
