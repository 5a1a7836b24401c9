"""How long a test waits for another process: as long as it needs, unless it hangs."""

HANGS_S = 3600.0  # no machine is so busy
