"""What does the simulation leave out? Cut the plant at the measured signals, locate, name, model, validate."""
