"""From light to digital numbers."""
