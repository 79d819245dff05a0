"""MyHDL blocks: layers."""
