"""How much a verb does in a time, by one worker and by two, and against what was kept before."""
