"""A chain as a file: MuJoCo, SDFormat, URDF, CSV."""
