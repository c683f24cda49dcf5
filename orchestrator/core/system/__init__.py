"""A system as data, and the plan of a run."""
