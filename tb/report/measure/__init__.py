"""Tables of what is measured."""
