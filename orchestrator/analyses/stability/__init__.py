"""Prediction of stability and error for every master, signal and order, from the linearised scenario."""
