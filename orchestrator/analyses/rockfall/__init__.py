"""Monte Carlo of rockfall: from the description of a site to trials, statistics and files."""
