"""Native FMUs: the kernels as machine code, with a thin runtime in C.

`entries` gives the kernels C signatures, `translate` compiles them to LLVM's intermediate language,
`machine_code` to object code for each platform, `tables` writes the component's metadata in C, and `runtime/`
implements FMI.
"""
