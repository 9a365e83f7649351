"""What a finished run amounts to: errors against the reference, contacts, diagnosis, friction."""
