"""From a rig to a MuJoCo model: legs, linkage, payload, straps, and the person who wears it."""
