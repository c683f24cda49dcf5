"""The impact as one page: kernels as WebAssembly, a co-simulation in the browser, its pictures."""
