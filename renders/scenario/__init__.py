"""Scenarios: TOML in, validated tables out."""
