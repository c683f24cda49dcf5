"""The contact loop in vectors: the only place with LLVM IR."""
