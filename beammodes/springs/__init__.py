"""Springs made for a purpose: tuned to one mode, or matched to several."""
