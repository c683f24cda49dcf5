"""Probes: each looks at one thing of an FMU, in a process of its own. A module for each theme."""
