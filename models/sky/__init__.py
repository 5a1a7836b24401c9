"""The stars, their light, and how a spacecraft stands among them."""
