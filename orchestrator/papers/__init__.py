"""Papers that are reproduced: one folder a paper, one module a study.

A study makes rows "quantity, paper, experiment, computed" and figures from many runs through the
FMUs. It is one module in the folder of its paper that defines ``STUDY``; nothing else has to be
changed to add one.
"""
