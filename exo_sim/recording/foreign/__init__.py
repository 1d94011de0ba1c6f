"""Recordings of real machines, in the formats their makers published them in, brought to the contract's table.

One file a source. Each function takes the published file and returns recordings; nothing is filtered, resampled or
fitted. What had to be decided (signs, zeros, what was left out) stands in the function's docstring.
"""
