"""Whole machines: a truth with many effects at once, laws varied inside each family, and equations shared with nothing else."""
