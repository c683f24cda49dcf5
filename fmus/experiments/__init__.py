"""Experiments that FMUs carry with them: what is done, and what has to come out.

Our seven components have a module here each, named after their folder. A component in a folder of
its own has its experiments in ``experiments.py`` beside its kernels. (Ours don't, as every Python
file beside kernels is a part of what these are compiled from.)
"""
