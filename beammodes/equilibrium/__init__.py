"""Large static deflection: bent, spinning and buckled shapes, and the linear model about them."""
