"""The studies of Mogami and Tamura (1973), settlement of sand under an impulse: one file for each, found by its ``STUDY``."""
