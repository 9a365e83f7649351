"""Assessment of a finished run: errors against the reference, contacts, diagnosis, friction."""
