"""The player of pages: plain JavaScript modules, a style, and the plot library that they use."""
