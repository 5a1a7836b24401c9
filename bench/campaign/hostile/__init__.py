"""Files and arguments that cannot be right, thousands of them, each by a seed."""
