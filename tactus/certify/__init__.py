"""``make certify``: a folder that shows that an export computes the network of its scene."""
