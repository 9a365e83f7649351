"""The FMUs as other tools see them: packaged files."""
