"""What `scripts/fuzz` is made of: sound inputs, edits that break them, the command run on them, and what it promises all the same."""
