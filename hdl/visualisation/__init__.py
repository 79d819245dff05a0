"""MyHDL blocks: visualisation."""
