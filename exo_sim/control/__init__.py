"""What the machine's joints are asked for, and how a valve gets a force."""
