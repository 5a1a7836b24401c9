"""What images of white dots add to a score, beside what all markers have."""
