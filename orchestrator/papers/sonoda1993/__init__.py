"""The studies of Sonoda et al. (1993): one file for each, found by its ``STUDY``."""
