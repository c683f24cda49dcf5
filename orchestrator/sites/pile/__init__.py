"""A driven pile, its hammer and its soil: from a file to components that can be computed."""
