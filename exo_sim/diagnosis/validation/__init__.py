"""Validation: errors on time and recordings that no parameter was fitted to, over windows and in one free run."""
