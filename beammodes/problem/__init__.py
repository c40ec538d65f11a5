"""The problem as given: a beam, its two ends, its load."""
