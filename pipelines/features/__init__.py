"""Features of a target that nobody has a model of, followed from image to image."""
