"""Model selection: which candidates the data support. It knows residuals, parameters and candidates, but no kind of subsystem."""
