"""Calibration: the fictitious modulus E_bar of a sand from a measured static loading test."""
