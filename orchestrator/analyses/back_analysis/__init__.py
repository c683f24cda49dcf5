"""Back-analysis of rockfall: the ground from where rocks came to rest, and a forecast."""
