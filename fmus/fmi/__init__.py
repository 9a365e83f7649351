"""Reads and writes the FMI file format."""
