"""The shared supply: the flow that all cylinders drew is the input, the pressure upstream of their valves is predicted.

Where it was recorded, the supply pressure is a measured input of every cylinder; why it sags is a question of its own.
"""
