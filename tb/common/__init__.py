"""What benches and properties share: driving, recording and comparing inside the simulator."""
