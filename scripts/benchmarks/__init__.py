"""The parts of scripts/benchmark, one subject a file; each has `measure(asked)` that returns figures and remarks."""
