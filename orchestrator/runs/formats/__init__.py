"""Results of a run in the formats of other programs: CSV, MAT 4 of Dymola, VTK."""
