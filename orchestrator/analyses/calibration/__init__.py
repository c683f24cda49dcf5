"""E_bar of a sand from static tests."""
