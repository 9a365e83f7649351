"""Cam followers: contact kinematics, and the cam contour for a given lift."""
