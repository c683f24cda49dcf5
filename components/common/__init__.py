"""What all components are made of: declarations, buffers, units, compilation."""
