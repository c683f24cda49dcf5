"""Small components of the impact systems, each in closed form: a folder each, as any component."""
