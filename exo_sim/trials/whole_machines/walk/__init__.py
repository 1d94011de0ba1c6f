"""Whole machines that somebody wears: cylinders across hips and knees, led by a gait, with effects in one to four of them."""
