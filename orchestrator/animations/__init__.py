"""Animations as MP4 or GIF: their formats, and how frames become a file."""
