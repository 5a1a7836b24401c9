"""The formats, a file each: they arrange label records and compute nothing of their own."""
