"""Physics of the rock shed, a folder per subsystem. Knows numpy and numba, nothing of FMI."""
