"""Films of line contacts, infinite and finite, that analyses compute; no component uses them."""
