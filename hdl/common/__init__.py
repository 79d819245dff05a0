"""Parts inlined into blocks: they never become entities of their own."""
