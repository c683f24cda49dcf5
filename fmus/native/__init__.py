"""FMUs of machine code, without Python in them."""
