"""tribocosim: the packages `models`, `fmus` and `orchestrator`, and the command."""
