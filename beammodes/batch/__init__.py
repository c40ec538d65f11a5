"""Studies: many chains declared at once, computed in chunks on one core, several or a cluster, and kept."""
