"""`python -m exo_sim VERB`."""

from __future__ import annotations

import sys

from exo_sim.cli import main

if __name__ == "__main__":
    sys.exit(main())
