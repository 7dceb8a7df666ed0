"""Disk cams: motion laws, programmes, followers and the curves they give. Knows nothing of plates or files."""
