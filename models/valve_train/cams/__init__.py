"""Cam profiles, defined by a law or a lift table."""
