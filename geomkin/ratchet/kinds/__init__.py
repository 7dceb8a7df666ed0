"""Recipe of ratchets."""
