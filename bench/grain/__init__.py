"""``make grain``: how much of what a frame shows is Monte-Carlo noise, or bias."""
