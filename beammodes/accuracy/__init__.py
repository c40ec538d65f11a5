"""How wrong a chain is: frequencies, deflections, shapes, buckling loads; and what to choose."""
