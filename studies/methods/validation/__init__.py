"""The package beside published numbers, one function a source."""
