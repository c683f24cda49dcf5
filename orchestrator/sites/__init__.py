"""Sites as people describe them in files."""
