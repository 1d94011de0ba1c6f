"""Estimation: free parameters of a plant, bounded least squares with priors, and how well a fit knows its numbers."""
