"""The papers' Suns in words: one text for help, start files and errors; it loads nothing."""

SUN_NAMES = "S1 to S7, E-SB, E-S1 to E-S36"
