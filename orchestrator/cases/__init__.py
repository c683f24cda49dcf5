"""Ready-made systems: data of the papers and the co-simulations that compute them."""
