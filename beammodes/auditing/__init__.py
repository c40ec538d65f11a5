"""Given chains, as arrays or in model files, judged beside their beams."""
