"""Written files read back and compared with the exact curves of their recipe."""
