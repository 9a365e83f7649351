"""Equations of FMUs for model exchange, to be integrated by tribocosim's solvers."""
