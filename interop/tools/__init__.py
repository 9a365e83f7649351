"""The tools, a file each; `interop` says what such a file has."""
