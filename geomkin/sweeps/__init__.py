"""A recipe made again and again with other values under some of its keys, and what came of each."""
