"""Sonoda, Satoh, Ishikawa, Ohta (1993): impact response of a sand cushion by DEM and RBSM.

Reproduced are the claims about the experiments (section 2), the static test (figs 12, 13, table 4),
the sixteen impacts in the laboratory (tables 2 and 5, figs 17 and 18), the time steps (fig. 19) and
the impacts at full scale on a rigid base (figs 20 to 22) and on girders (table 6, figs 23, 24).
"""
