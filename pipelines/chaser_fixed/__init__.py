"""The chaser-fixed camera's pipeline."""
