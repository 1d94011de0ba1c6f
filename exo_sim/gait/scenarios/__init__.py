"""One file a scenario; a new file here is a new scenario of its name. Each holds a `Scenario` called `SCENARIO`."""
