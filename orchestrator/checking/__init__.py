"""Checks of any FMU for co-simulation: what it declares, and what it does when it is called."""
