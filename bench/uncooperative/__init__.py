"""The uncooperative target: suites on points, runs on frames, their scores and reports."""
