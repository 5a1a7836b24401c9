"""A robot arm on the chaser: its joints and links, where they go, and what they may not touch."""
