"""Actuators against joint loads: what each joint must carry, what a cylinder can do, and which cylinder does it best."""
