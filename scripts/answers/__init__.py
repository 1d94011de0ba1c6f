"""The cases of `scripts/same_answers`, and how a version of the program is asked about them."""
