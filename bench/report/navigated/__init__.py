"""The page of a chaser that navigates for itself before its target."""
