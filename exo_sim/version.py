"""Which version this is; what writes it into files imports it from here."""

VERSION = "0.2.0"
