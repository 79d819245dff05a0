"""MyHDL blocks: sensing."""
