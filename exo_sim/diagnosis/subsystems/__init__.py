"""The subsystems of a plant, each cut out at measured signals: gas of a cylinder, balance of forces, shared supply."""
