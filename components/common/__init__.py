"""Parts of all components: declarations, buffers, units, laws that several share, compilation."""
