"""The report: what the studies stored, as one page that needs nothing but a browser."""
