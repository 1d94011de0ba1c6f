"""The gas in the cylinders: pure compiled functions in SI. Knows nothing of MuJoCo, files or people."""
