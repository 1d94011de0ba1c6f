"""The stages of a diagnosis in their order: read, sort, examine every subsystem, validate, revise until nothing changes, and report."""
