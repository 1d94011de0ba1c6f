"""A truth of other people's making: cylinders of Cantera's reactors, walls and flow devices (Goodwin et al., cantera.org, BSD-3)."""
