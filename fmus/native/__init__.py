"""FMUs of machine code."""
