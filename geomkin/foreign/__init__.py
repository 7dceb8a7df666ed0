"""Files of other programs as recipes."""
