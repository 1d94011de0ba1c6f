"""What `scripts/faults` is made of: commands that write, what is done to them meanwhile, and what must be found afterwards."""
