"""Parts and tables as files. Nothing here knows a mechanism."""
