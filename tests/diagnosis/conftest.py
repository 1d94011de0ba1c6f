"""Makes the small models beside this file importable from the rooms below."""
