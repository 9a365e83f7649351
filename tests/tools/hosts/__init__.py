"""The tools, a file each; `tests.tools` says what such a file has."""
