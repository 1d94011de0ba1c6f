"""The balance of forces of one joint or along one rod: motion, pressures and outside force are measured, what resists is asked."""
