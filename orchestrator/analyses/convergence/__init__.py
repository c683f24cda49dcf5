"""Convergence: how far the results of a shed hang on the sizes of sand discs and beam elements."""
