"""From a request to a system that can be run."""
