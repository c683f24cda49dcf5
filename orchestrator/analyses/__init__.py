"""Analyses next to the co-simulation: rockfall on a slope, driven piles, calibration of the sand.

Each is a folder with ``run.py`` (the function that carries it out), ``result.py`` (the object that
it returns), ``files.py``, ``tables.py`` and ``pictures.py``; ``frame.py`` is shared by all.
"""
