"""Tables and numbers of the papers in README and docs, written from kept results."""
