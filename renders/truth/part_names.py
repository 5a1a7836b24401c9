"""Names of labels that are no part of the target's own; no renderer is loaded for them."""

MARKER_LABEL = "retroreflectors"
CHASER_LABEL = "chaser"
