"""Tables of `docs/walking.md` that are long enough for a file of their own."""
