"""What all benches share: driving, recording, comparing, and running a simulator."""
