"""Networks whose edges are learned functions of one variable, made of cubic B-splines."""
