"""What is tried of a tumbling target beside a run: acquisition without a prior, many times."""
