"""MyHDL blocks: link."""
