"""Kernels as machine code without Python: their translation, and their derivatives."""
