"""MyHDL blocks: networks."""
