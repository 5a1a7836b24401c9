"""Studies of many runs: work spread over processes, kept as it is done, always the same bits."""
