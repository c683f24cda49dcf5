"""The exchange loop and its books."""
