"""The chain in motion: moving bases, damping, time integration, superposition."""
