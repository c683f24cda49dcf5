"""System structures of the SSP standard, 1.0 and 2.0: read into systems, and written from them.

`System Structure and Parameterization <https://ssp-standard.org>`_ is a standard of the Modelica
Association. The schemas in ``schemas/`` are its own, under their licence.
"""
