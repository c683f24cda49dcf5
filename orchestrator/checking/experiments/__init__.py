"""Experiments that an FMU carries with it: read with care, carried out, compared."""
