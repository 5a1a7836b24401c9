"""Estimates of two cameras of one flight, made one."""
