"""What images of white dots add to the report."""
