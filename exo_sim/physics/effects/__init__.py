"""The physics that the paper leaves out: one file each, which declares the effect and holds its one small function.

The line that calls the function stands in `exo_sim/physics/plant.py`, at the physical place where the effect acts.
"""
