"""Uto, Fuyuki, Kondo, Yamada (about 1974): Smith's scheme for the impact on a pile or rod.

Reproduced are figures 6, 7, 8, 10, 11 and 13 and the claims in the text: steps, reflection at the
toe, energy, the ground as a rod. All are computed with the kernels of the component; no FMU is run.
"""
