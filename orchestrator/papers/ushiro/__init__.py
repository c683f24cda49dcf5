"""The studies of Ushiro, A study on computer simulation of rockfalls (DRSP): one file for each, found by its ``STUDY``."""
