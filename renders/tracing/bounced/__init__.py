"""Sunlight that reached a surface after one bounce or more, traced once and looked up after."""
