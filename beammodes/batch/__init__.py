"""Studies: many chains declared at once, computed in chunks on one core, many or a cluster, and stored."""
