"""What `import exo_sim as exo` offers: the verbs of the command as functions that take and return objects.

Quantities are SI numbers, or text with a unit ("34 kg", "7 bar"). Rigs, recordings and column maps are paths or objects. What is wrong
with an input is an `exo.ExoSimError` whose message is one line; nothing is printed. The command `exo-sim` calls these functions.
"""
