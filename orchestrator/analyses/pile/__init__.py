"""Wave analysis of a driven pile or rod: ``rockshed pile``."""
