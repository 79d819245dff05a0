"""MyHDL blocks and the exporter."""
