"""Small vibration: the linear model in its factors, its modes, and the step that it allows."""
