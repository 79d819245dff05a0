"""The report: plots and pictures as SVG, and the page that holds them."""
