"""Components as WebAssembly: their kernels in a module that a browser, or any other host, runs."""
