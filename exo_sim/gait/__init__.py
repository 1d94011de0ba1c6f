"""Recorded walking as a smooth reference motion, and the scenarios built on it."""
