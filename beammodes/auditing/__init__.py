"""A chain that somebody else made, judged."""
