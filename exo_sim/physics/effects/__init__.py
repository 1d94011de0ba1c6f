"""The physics that the paper leaves out: one file each, which declares the effect and holds its small functions.

What adds up in a balance enters itself there (`exo_sim/physics/terms.py`); what takes another law's place is called by name where it
acts, in `balances.py`, `nodes.py`, `plant.py`, `friction.py` or `transmission.py`.
"""
