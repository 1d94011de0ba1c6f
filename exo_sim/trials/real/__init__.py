"""Recordings of real machines as cases: what is known of each, and what a diagnosis of it is worth."""
