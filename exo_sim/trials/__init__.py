"""The proving ground: a truth that shares nothing with the simulator under test, sealed before anybody looks."""
