"""The pipeline for a known target that does not help."""
