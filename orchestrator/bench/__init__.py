"""Speed and price of coupling, each figure as a ratio within one interleaved run."""
