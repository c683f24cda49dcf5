"""Input files of the commands that take a site: TOML, with every problem told at its place."""
