"""Runs benches, proves properties, and proves that an export computes its network."""
