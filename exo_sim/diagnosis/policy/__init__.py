"""Every number that decides, by the stage where it does: what it is, why it is so large, and the experiment that set it.

Budgets count among them: what is not fitted is not found. Steps, tolerances, grids, widths of windows and of filters are numerics
and stand where they are used.
"""
