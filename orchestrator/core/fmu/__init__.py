"""FMUs as the master takes them."""
