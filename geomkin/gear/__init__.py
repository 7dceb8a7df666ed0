"""Gears: the rack that cuts them and the teeth it leaves. Knows nothing of plates or files."""
