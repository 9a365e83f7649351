"""What scatter of parameters and grinding errors of cams do to a train's figures of merit."""
