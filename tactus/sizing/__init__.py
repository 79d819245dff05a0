"""How large and how fast a design would be, and which one is the smallest that is fast enough."""
