"""Cams and other continuous parameters that do best within limits."""
