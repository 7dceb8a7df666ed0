"""The page of a scene: player, plots, checks and parts in one file."""
