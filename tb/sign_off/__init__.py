"""What is proved, counted and run of each block before its hardware is signed off."""
