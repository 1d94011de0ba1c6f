"""The pneumatics under MuJoCo: the plug-in, and running scenarios."""
