"""The report of image pairs."""
