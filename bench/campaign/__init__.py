"""A campaign of faults: what kills, spoils or starves the bench, and whether it stood."""
