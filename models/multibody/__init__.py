"""Constrained multibody systems: bodies, joints and force elements. The multipliers are the joint loads."""
