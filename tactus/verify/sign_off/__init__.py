"""The proofs, counts and runs that each block needs before its hardware is signed off."""
