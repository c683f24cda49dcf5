"""Monte Carlo of rockfall on a slope: trials, statistics at lines and barriers, files, pictures."""
