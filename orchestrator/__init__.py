"""Co-simulation of FMUs, and the command line, cases and pictures on top of it."""
