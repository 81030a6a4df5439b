"""The package beside published numbers."""
