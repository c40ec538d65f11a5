"""The nonlinear equations of motion: the physics, once, and the two engines that read it."""
