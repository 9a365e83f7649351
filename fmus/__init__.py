"""tribocosim: FMU packaging."""
