"""A machine that exists only to be measured: own equations, own integrator, own instruments."""
