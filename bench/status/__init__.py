"""What of a folder of ours is done, runs, failed and is left."""
