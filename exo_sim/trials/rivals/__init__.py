"""Simpler tools to hold a diagnosis against, on the same cases and under the same contract."""
