"""What a drive period costs."""
