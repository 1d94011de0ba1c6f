"""What a fitted model still misses: errors along a recording, the force or flow behind them, and the curve that describes it."""
