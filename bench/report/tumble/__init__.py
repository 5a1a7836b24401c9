"""The report of a tumble."""
