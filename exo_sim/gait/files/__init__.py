"""Readers of walking trials, one file a format: each brings what its format says to `gait.trial`."""
