"""Studies: many runs through the FMUs, brought together into rows "quantity, paper, experiment, computed" and figures.

A study is one file in the package of its paper that defines ``STUDY``; nothing else has to be changed to add one.
"""
