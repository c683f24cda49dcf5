"""Wave analysis of a driven pile or rod: blows, bearing graph, files, pictures."""
