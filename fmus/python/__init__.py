"""FMUs with Python inside, as pythonfmu makes them."""
