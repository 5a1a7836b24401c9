"""The chains: from streams through pipelines to parts of a score, one value in one file each."""
