"""The nonlinear equations of motion, once, the two engines that read them, and the shapes at rest."""
