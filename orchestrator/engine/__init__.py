"""The exchange of values between participants, and the sweeps that advance them."""
