"""The FMU under check, called through its C functions, the same for FMI 2.0 and 3.0."""
