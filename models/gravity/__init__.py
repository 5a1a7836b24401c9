"""The Earth's gravity, and what else pulls and pushes a satellite."""
