"""What one subsystem's result changes in the data of another: pressures of the gas in the balances of forces, and the reverse."""
