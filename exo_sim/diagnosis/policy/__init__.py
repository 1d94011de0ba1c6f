"""Every number that decides, by the stage where it does: what it is, why it is so large, and the experiment that set it.

Budgets (how many candidates are fitted), widths of filters and other numerics are no decisions; they stand where they are used.
"""
