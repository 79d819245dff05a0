"""``make report``: what a scene is, how far off, what it costs, and how that was found."""
