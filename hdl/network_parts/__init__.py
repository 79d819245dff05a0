"""Parts that networks share, inlined into these: they hold blocks and are none themselves."""
