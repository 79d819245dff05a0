"""Parts that networks share. They hold blocks but become no entities: they are inlined."""
