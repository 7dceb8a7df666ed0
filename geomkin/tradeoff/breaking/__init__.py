"""Where methods fail: cells of the stability study, a file of them for each kind of mechanism."""
