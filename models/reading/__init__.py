"""The one door of every text file: read once, bounded, and checked for being possible."""
