"""The doors of mesh files: what they claim is held against what is there, before any is parsed."""
