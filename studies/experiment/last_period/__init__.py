"""Why p10 was the last period of the letter."""
