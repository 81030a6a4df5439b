"""The least model that answers each question."""
