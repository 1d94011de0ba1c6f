"""The gas of one cylinder: command, supply and piston motion are measured inputs, both chamber pressures are predicted."""
