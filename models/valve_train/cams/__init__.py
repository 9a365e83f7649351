"""Cam profiles: by a law, or through points."""
