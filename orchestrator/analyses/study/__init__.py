"""Studies: a system with values that vary, by levels or by distributions, and what follows."""
