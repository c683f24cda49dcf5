"""FMI-LS-WASM: the binary of an FMU that hosts of WebAssembly run."""

PLATFORM = "wasm"
"""Name that asks for it among platforms."""
