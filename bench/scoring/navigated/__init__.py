"""A chaser that navigates for itself held against its flight, and its target against its motion."""
