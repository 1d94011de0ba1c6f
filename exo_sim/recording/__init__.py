"""Recordings: one table of signals in memory, its readers and writers, and the rerun scene."""
