"""FMUs in processes of their own: what one of them does there harms nobody else."""
