"""Exchange steps: at which order a co-simulation converges, and which step is fine enough."""
