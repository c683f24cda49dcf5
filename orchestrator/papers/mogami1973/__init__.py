"""Mogami and Tamura (1973): plastic settlement of sandy ground under an impulsive load.

Reproduced are the mass that moves, equation (1); the settlement that follows from a
resistance linear in time, (2) to (7); and the two fits to the 96 plate tests, (11) and (12).
"""
