"""MyHDL blocks: instruments."""
