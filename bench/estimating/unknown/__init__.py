"""What is made of an unknown target beside a run: its surface and its cloud, as files."""
