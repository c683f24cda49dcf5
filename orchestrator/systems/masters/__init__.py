"""Masters that run the impact systems, each in a process of its own."""
