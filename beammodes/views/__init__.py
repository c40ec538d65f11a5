"""Films of motions and drawings of chains."""
