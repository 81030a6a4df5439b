"""One approach of the tip to the plate: the cases, the rows, what is read off them, and the figures."""
