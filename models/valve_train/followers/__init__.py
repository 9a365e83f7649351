"""Followers of cams: kinematics of their contact, and the cam that moves them by a given lift."""
