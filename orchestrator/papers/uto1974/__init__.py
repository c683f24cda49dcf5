"""The studies of Uto, Fuyuki, Kondo, Yamada (about 1974): one file for each, found by its ``STUDY``."""
