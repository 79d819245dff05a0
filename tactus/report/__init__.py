"""``make report``: what a scene is, its errors, its costs, and how these were measured."""
