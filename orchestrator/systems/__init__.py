"""Impact systems: small coupled problems with known solutions, for any master of a co-simulation.

A folder each: the system as data (``SYSTEM``), its truth, and a page that derives it. The parts in
``parts`` are components like any other; :mod:`rockshed.systems.files` writes the whole suite as
FMUs, SSPs and tables that need nothing of this program, and :mod:`rockshed.systems.measuring` runs
it in every master that is installed.
"""
