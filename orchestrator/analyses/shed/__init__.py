"""Analyses of a shed from a project: what its choices make of the results."""
