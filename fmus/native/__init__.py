"""FMUs that need nothing but themselves: the kernels as machine code with a thin runtime in C.

`entries` are the kernels as C calls them, `translate` makes of them LLVM's intermediate language, `compile`
machine code of it for every platform, `tables` the component's metadata as C, and `runtime/` is the FMI.
"""
