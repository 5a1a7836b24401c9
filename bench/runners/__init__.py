"""Past one machine: the same command, a share of it at a time, on a cluster's nodes."""
