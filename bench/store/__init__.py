"""The verbs of the store of light."""
