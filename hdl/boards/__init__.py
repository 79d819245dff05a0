"""Makes bitstreams, which put a scene on a board."""
