"""Analyses beside the co-simulation: rockfall, pile, calibration."""
