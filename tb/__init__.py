"""The cocotb benches, their runner, sign-off, the report and the monitor."""
