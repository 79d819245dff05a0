"""The tool: from a scene to networks, hardware, proof, report and certificate."""
