"""One approach of the tip to the plate: what is varied, the rows, their figures and what they say."""
