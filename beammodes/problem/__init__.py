"""What is given: a beam, what stands at its two ends, and what loads it."""
