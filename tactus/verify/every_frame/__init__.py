"""Proves that an export computes its network for every frame (docs/every-frame.md)."""
