"""A slope, its ground and its barriers: from a file to a component that can be computed."""
