"""Impacts (being written)."""
