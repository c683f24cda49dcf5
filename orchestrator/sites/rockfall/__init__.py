"""A slope, its ground and its barriers, from a file."""
