"""Datasets in the formats that other people's tools read, all from one label record an exposure."""
