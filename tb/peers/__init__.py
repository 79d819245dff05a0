"""``make peers``: compares our hardware with that of other projects for the same weights."""
