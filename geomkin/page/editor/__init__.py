"""The page of the studio: the player with handles, and a form of the recipe; plain JavaScript modules and a style."""
