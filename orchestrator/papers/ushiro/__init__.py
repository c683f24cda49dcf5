"""Ushiro, A study on computer simulation of rockfalls (DRSP).

Reproduced is figure 7, the coefficient of restitution over the normal speed of an impact.
"""
