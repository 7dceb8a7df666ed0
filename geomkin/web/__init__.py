"""The player of pages, as a browser takes it: plain modules and a style, with the plot library that they use."""
