"""The letter's other claims, one file a claim."""
