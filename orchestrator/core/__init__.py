"""The co-simulation core: drives any FMU for co-simulation of FMI 2.0.

It knows an FMU by its model description and the FMI calls only.
"""
