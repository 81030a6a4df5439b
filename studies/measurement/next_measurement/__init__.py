"""Where to measure next, once parameters are known: `python -m studies identify --next NAMES`.

``model``       the information in one orbit, its limits, the best places
``figure``      tables and figure: errors over the plane of frequency and excess
"""
