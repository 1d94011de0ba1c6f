"""The outcome: verdict, where the mismatch is, what to record next, and the improved rig."""
