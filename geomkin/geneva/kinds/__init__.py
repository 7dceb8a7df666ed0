"""Recipe of Geneva drives."""
