"""MyHDL blocks: activation."""
