"""A rock shed as a project file: rock, cushion, roof, supports, and all that follows from them."""
