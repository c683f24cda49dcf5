"""Speed and price of coupling, each quantity as a ratio within one interleaved run."""
